#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace grainfield::tracking {

/// A row and a column that may be joined, and what that costs.
struct AssignmentPair {
    std::uint32_t row;
    std::uint32_t column;
    double cost;
};

/// Optimal assignment of rows to columns on a sparse list of pairs,
///
///     min  Σ_{joined} cost(row, column) + Σ_{rows left over} leave(row),
///
/// each row and column joined at most once; columns left over cost nothing.
///
/// Shortest augmenting paths with prices (`jonker1987`): a row starts at its cheapest column if
/// that is free; for every other row Dijkstra's search on reduced costs ≥ 0 finds the cheapest
/// chain of exchanges. A search ends as soon as leaving some row of the chain alone is cheaper, so
/// that it stays local. Exact up to rounding, deterministic; equal costs go to the smaller column.
/// Cost O(Σ pairs searched · log): close to linear for neighbours in the plane, at worst
/// O(rows · pairs · log). Workspaces are kept from call to call.
class AssignmentSolver {
 public:
    /// Pairs must be sorted by row. Returns the column of each row, −1 if it is left over.
    const std::vector<std::int32_t>& solve(std::uint32_t rows, std::uint32_t columns,
                                           std::span<const AssignmentPair> pairs,
                                           std::span<const double> leave);

    /// Prices of the last solution: row_price + column_price ≤ cost on every pair with equality on
    /// joined ones, row_price ≤ leave, column_price ≤ 0 and 0 on free columns. Then Σ row_price +
    /// Σ column_price equals the cost, which proves that no assignment is cheaper.
    const std::vector<double>& row_price() const { return row_price_; }
    const std::vector<double>& column_price() const { return column_price_; }

 private:
    void start(std::span<const double> leave);
    void augment(std::uint32_t start_row, std::span<const double> leave);
    void search(std::uint32_t row, double distance, std::span<const double> leave);

    std::span<const AssignmentPair> pairs_;
    std::vector<std::uint32_t> first_;  ///< pair of each row
    std::vector<std::int32_t> column_of_, row_of_;
    std::vector<double> row_price_, column_price_;

    // The search of one augmentation.
    std::vector<double> distance_;         ///< of columns
    std::vector<std::int32_t> came_from_;  ///< row before each column
    std::vector<std::uint32_t> touched_;   ///< columns to reset
    std::vector<std::pair<double, std::uint32_t>> heap_, settled_;
    double leave_distance_ = 0;  ///< cheapest end by leaving a row alone
    std::int32_t leave_row_ = -1;
};

}  // namespace grainfield::tracking
