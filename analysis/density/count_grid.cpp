#include "analysis/density/count_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "analysis/density/window_kernel.h"

namespace grainfield::analysis {
namespace {

constexpr double most_cells = 1 << 14;

using Integers = std::int32_t __attribute__((vector_size(16)));
using Unsigned = std::uint32_t __attribute__((vector_size(16)));
using Lanes = double __attribute__((vector_size(32)));

struct RowSums {
    double sum = 0;
    double squares = 0;
};

[[gnu::always_inline]] inline void load(Unsigned& to, const std::uint32_t* from) {
    std::memcpy(&to, from, sizeof to);
}

// Windows whose lower corners lie on row `low` and upper ones on row `high`, columns 0 … count − 1:
// Σ (N − shift) and Σ (N − shift)².
[[gnu::always_inline]] inline RowSums row_sums(const std::uint32_t* low, const std::uint32_t* high,
                                               int m, int count, std::uint32_t shift) {
    Lanes sum = {0, 0, 0, 0};
    Lanes squares = {0, 0, 0, 0};
    int x = 0;
    for (; x + 4 <= count; x += 4) {
        Unsigned a, b, c, d;
        load(a, low + x);
        load(b, low + x + m);
        load(c, high + x);
        load(d, high + x + m);
        const auto difference = reinterpret_cast<Integers>((d - c) - (b - a) - shift);
        const Lanes value = __builtin_convertvector(difference, Lanes);
        sum += value;
        squares += value * value;
    }
    RowSums result{(sum[0] + sum[1]) + (sum[2] + sum[3]),
                   (squares[0] + squares[1]) + (squares[2] + squares[3])};
    for (; x < count; ++x) {
        const double value =
            static_cast<std::int32_t>((high[x + m] - high[x]) - (low[x + m] - low[x]) - shift);
        result.sum += value;
        result.squares += value * value;
    }
    return result;
}

RowSums row_sums_plain(const std::uint32_t* low, const std::uint32_t* high, int m, int count,
                       std::uint32_t shift) {
    return row_sums(low, high, m, count, shift);
}

#if defined(__x86_64__) && defined(__GNUC__)
[[gnu::target("avx2")]] RowSums row_sums_avx2(const std::uint32_t* low, const std::uint32_t* high,
                                              int m, int count, std::uint32_t shift) {
    return row_sums(low, high, m, count, shift);
}
const auto best_row_sums = __builtin_cpu_supports("avx2") != 0 ? row_sums_avx2 : row_sums_plain;
#else
const auto best_row_sums = row_sums_plain;
#endif

// A position that is a multiple of the cell must not fall one cell short by rounding.
int cells_within(double length, double cell) {
    return static_cast<int>(std::clamp(std::floor(length / cell * (1 + 1e-12)), 0.0, most_cells));
}

}  // namespace

CountGrid::CountGrid(const Box& box, double step, double border) {
    const auto set = [&](std::size_t axis, double Vec2::*member) {
        const double length = box.length.*member;
        periodic[axis] = box.boundary[axis] == Boundary::periodic;
        if (periodic[axis]) {
            cells[axis] = static_cast<int>(std::clamp(std::round(length / step), 1.0, most_cells));
            cell.*member = length / cells[axis];
            origin.*member = box.origin.*member;
        } else {
            cells[axis] = cells_within(std::max(0.0, length - 2 * border), step);
            cell.*member = step;
            origin.*member = box.origin.*member + 0.5 * (length - cells[axis] * step);
        }
    };
    set(0, &Vec2::x);
    set(1, &Vec2::y);
}

std::int64_t CountGrid::positions(int m) const {
    if (!fits(m)) return 0;
    const std::int64_t x = periodic[0] ? cells[0] : cells[0] - m + 1;
    const std::int64_t y = periodic[1] ? cells[1] : cells[1] - m + 1;
    return x * y;
}

std::vector<std::int32_t> CountGrid::cells_of(std::span<const Vec2> points) const {
    std::vector<std::int32_t> found;
    found.reserve(points.size());
    for (const Vec2& p : points) {
        double column = (p.x - origin.x) / cell.x;
        double row = (p.y - origin.y) / cell.y;
        // A wrapped point just below the upper edge may round onto it.
        if (periodic[0]) column = std::clamp(column, 0.0, cells[0] - 1.0);
        if (periodic[1]) row = std::clamp(row, 0.0, cells[1] - 1.0);
        if (!(column >= 0 && column < cells[0] && row >= 0 && row < cells[1])) continue;
        // Truncation is floor here.
        found.push_back(static_cast<std::int32_t>(row) * cells[0] +
                        static_cast<std::int32_t>(column));
    }
    return found;
}

std::vector<std::int32_t> CountGrid::count(std::span<const Vec2> points) const {
    std::vector<std::int32_t> contents(size(), 0);
    for (const std::int32_t at : cells_of(points)) ++contents[static_cast<std::size_t>(at)];
    return contents;
}

WindowCounter::WindowCounter(const CountGrid& grid, std::span<const std::int32_t> contents,
                             int largest)
    : grid_(grid) {
    const auto nx = static_cast<std::size_t>(grid.cells[0]);
    const auto ny = static_cast<std::size_t>(grid.cells[1]);
    const auto more = static_cast<std::size_t>(std::max(largest, 0));
    const std::size_t wide = nx + (grid.periodic[0] ? more : 0);
    const std::size_t high = ny + (grid.periodic[1] ? more : 0);
    columns_ = wide + 1;
    for (const std::int32_t content : contents) points_ += static_cast<std::uint64_t>(content);
    const auto fill = [&](auto& table) {
        using Entry = std::remove_reference_t<decltype(table[0])>;
        for (std::size_t y = 0; y < high; ++y) {
            const std::int32_t* row = contents.data() + (y % ny) * nx;
            const Entry* below = table.data() + y * columns_;
            Entry* above = table.data() + (y + 1) * columns_;
            std::uint32_t sum = 0;
            for (std::size_t x = 0; x < wide; ++x) {
                sum += static_cast<std::uint32_t>(row[x < nx ? x : x % nx]);
                above[x + 1] = static_cast<Entry>(below[x + 1] + sum);
            }
        }
    };
    if (points_ <= NarrowTable::most) {
        narrow_.assign(columns_ * (high + 1) + NarrowTable::padding, 0);
        fill(narrow_);
    } else {
        table_.assign(columns_ * (high + 1), 0);
        fill(table_);
    }
}

WindowSums WindowCounter::sums(int m) const {
    if (!grid_.fits(m)) return {};
    const int columns = grid_.periodic[0] ? grid_.cells[0] : grid_.cells[0] - m + 1;
    const int rows = grid_.periodic[1] ? grid_.cells[1] : grid_.cells[1] - m + 1;
    if (narrow_.empty()) return wide_sums(m, columns, rows);
    const NarrowSums sums = window_sums(
        {narrow_.data(), columns_}, static_cast<std::size_t>(m), static_cast<std::size_t>(columns),
        static_cast<std::size_t>(rows), static_cast<std::uint32_t>(points_));
    return {static_cast<Wide>(sums.sum), static_cast<Wide>(sums.squares)};
}

WindowSums WindowCounter::wide_sums(int m, int columns, int rows) const {
    WindowSums result;
    const auto row = [&](int y) { return table_.data() + static_cast<std::size_t>(y) * columns_; };
    // Any integer near the mean content keeps the squares small; the first window will do.
    const std::uint32_t shift = (row(m)[m] - row(m)[0]) - (row(0)[m] - row(0)[0]);
    for (int y = 0; y < rows; ++y) {
        const RowSums part = best_row_sums(row(y), row(y + m), m, columns, shift);
        result.sum += static_cast<Wide>(part.sum);
        result.squares += static_cast<Wide>(part.squares);
    }
    const Wide count = grid_.positions(m);
    const Wide offset = static_cast<std::int32_t>(shift);
    result.squares += 2 * offset * result.sum + count * offset * offset;
    result.sum += count * offset;
    return result;
}

}  // namespace grainfield::analysis
