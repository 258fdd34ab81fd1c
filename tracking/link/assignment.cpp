#include "tracking/link/assignment.h"

#include <algorithm>
#include <functional>
#include <limits>

namespace grainfield::tracking {
namespace {
constexpr double kInfinity = std::numeric_limits<double>::infinity();
}

const std::vector<std::int32_t>& AssignmentSolver::solve(std::uint32_t rows, std::uint32_t columns,
                                                         std::span<const AssignmentPair> pairs,
                                                         std::span<const double> leave) {
    pairs_ = pairs;
    first_.assign(rows + 1, 0);
    for (const AssignmentPair& p : pairs) ++first_[p.row + 1];
    for (std::uint32_t r = 0; r < rows; ++r) first_[r + 1] += first_[r];
    column_of_.assign(rows, -1);
    row_of_.assign(columns, -1);
    row_price_.assign(rows, 0);
    column_price_.assign(columns, 0);
    distance_.assign(columns, kInfinity);
    came_from_.assign(columns, -1);
    start(leave);
    for (std::uint32_t row = 0; row < rows; ++row) {
        if (column_of_[row] < 0 && row_price_[row] < leave[row]) augment(row, leave);
    }
    return column_of_;
}

/// Prices of the rows at their cheapest choice; rows without a rival are done.
void AssignmentSolver::start(std::span<const double> leave) {
    for (std::uint32_t row = 0; row < column_of_.size(); ++row) {
        double least = leave[row];
        std::int32_t column = -1;
        for (std::uint32_t k = first_[row]; k < first_[row + 1]; ++k) {
            const AssignmentPair& p = pairs_[k];
            const auto c = static_cast<std::int32_t>(p.column);
            if (p.cost < least || (p.cost == least && (column < 0 || c < column))) {
                least = p.cost;
                column = c;
            }
        }
        row_price_[row] = least;
        if (column >= 0 && row_of_[static_cast<std::size_t>(column)] < 0) {
            column_of_[row] = column;
            row_of_[static_cast<std::size_t>(column)] = static_cast<std::int32_t>(row);
        }
    }
}

void AssignmentSolver::search(std::uint32_t row, double distance, std::span<const double> leave) {
    const double base = distance - row_price_[row];
    if (base + leave[row] < leave_distance_) {
        leave_distance_ = base + leave[row];
        leave_row_ = static_cast<std::int32_t>(row);
    }
    for (std::uint32_t k = first_[row]; k < first_[row + 1]; ++k) {
        const std::uint32_t c = pairs_[k].column;
        // Rounding must not lead backwards.
        const double d = std::max(distance, base + pairs_[k].cost - column_price_[c]);
        if (d > leave_distance_ || d >= distance_[c]) continue;
        if (distance_[c] == kInfinity) touched_.push_back(c);
        distance_[c] = d;
        came_from_[c] = static_cast<std::int32_t>(row);
        heap_.emplace_back(d, c);
        std::push_heap(heap_.begin(), heap_.end(), std::greater<>());
    }
}

void AssignmentSolver::augment(std::uint32_t start_row, std::span<const double> leave) {
    heap_.clear();
    settled_.clear();
    leave_distance_ = kInfinity;
    search(start_row, 0, leave);
    std::int32_t column = -1;  // where the path ends; −1: leave_row_ is left alone
    double length = 0;
    while (true) {
        if (heap_.empty() || heap_.front().first > leave_distance_) {
            length = leave_distance_;
            break;
        }
        std::pop_heap(heap_.begin(), heap_.end(), std::greater<>());
        const auto [d, c] = heap_.back();
        heap_.pop_back();
        if (d > distance_[c]) continue;  // a shorter way was found since
        if (row_of_[c] < 0) {
            column = static_cast<std::int32_t>(c);
            length = d;
            break;
        }
        settled_.emplace_back(d, c);
        search(static_cast<std::uint32_t>(row_of_[c]), d, leave);
    }

    row_price_[start_row] += length;
    for (const auto& [d, c] : settled_) {
        column_price_[c] -= length - d;
        row_price_[static_cast<std::size_t>(row_of_[c])] += length - d;
    }
    if (column < 0) {
        // The row left alone gives its column to the row that came for it.
        const auto left = static_cast<std::size_t>(leave_row_);
        column = column_of_[left];
        column_of_[left] = -1;
    }
    while (column >= 0) {
        const auto c = static_cast<std::size_t>(column);
        const auto row = static_cast<std::size_t>(came_from_[c]);
        row_of_[c] = static_cast<std::int32_t>(row);
        std::swap(column, column_of_[row]);
        if (row == start_row) break;
    }
    for (const std::uint32_t c : touched_) distance_[c] = kInfinity;
    touched_.clear();
}

}  // namespace grainfield::tracking
