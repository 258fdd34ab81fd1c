#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/box.h"

namespace grainfield::analysis {

/// Integer wide enough for exact sums of squared counts.
__extension__ using Wide = __int128;

/// A square grid of cells laid over the part of a box that windows may cover. Windows are m × m
/// cells, their corners on grid lines. A cell holds the points with low ≤ x < high.
struct CountGrid {
    Vec2 origin;  ///< corner of cell (0, 0) [a]
    Vec2 cell;    ///< size of a cell [a]
    std::array<int, 2> cells{0, 0};
    std::array<bool, 2> periodic{false, false};

    /// Cells of about `step` [a]; on walled axes strips of width `border` [a] stay free on both
    /// sides and the cells are centred. On periodic axes the cells fill the box exactly.
    CountGrid(const Box& box, double step, double border);

    std::size_t size() const {
        return static_cast<std::size_t>(cells[0]) * static_cast<std::size_t>(cells[1]);
    }
    bool fits(int m) const { return m >= 1 && m <= cells[0] && m <= cells[1]; }

    /// Number of positions of an m × m window: all of them on periodic axes.
    std::int64_t positions(int m) const;

    /// The cells of the points, row-major; points outside the grid are left out. Cost O(N).
    std::vector<std::int32_t> cells_of(std::span<const Vec2> points) const;

    /// Points per cell, row-major; points outside the grid are not counted. Cost O(N).
    std::vector<std::int32_t> count(std::span<const Vec2> points) const;
};

/// Sums over all positions p of an m × m window, N_p the content of the window.
struct WindowSums {
    Wide sum = 0;      ///< Σ_p N_p
    Wide squares = 0;  ///< Σ_p N_p²
};

/// Window sums from cell contents by a summed-area table (`crow1984`): four look-ups a window.
/// Contents are ≥ 0 and a window must hold less than 2^31. Exact for up to 32,767 points in all,
/// in numbers of 16 bits; for more exact in integers as long as positions-in-a-row × (largest
/// difference between windows)² < 2^53, else to 1e-15.
class WindowCounter {
 public:
    WindowCounter(const CountGrid& grid, std::span<const std::int32_t> contents, int largest);
    WindowSums sums(int m) const;

 private:
    WindowSums wide_sums(int m, int columns, int rows) const;

    CountGrid grid_;
    std::size_t columns_;
    std::uint64_t points_ = 0;
    // Modulo 2^32 or 2^16: only differences are used. One of them is empty.
    std::vector<std::uint32_t> table_;
    std::vector<std::uint16_t> narrow_;
};

}  // namespace grainfield::analysis
