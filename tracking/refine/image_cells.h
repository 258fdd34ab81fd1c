#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// Square cells over an image. Points outside it count for the nearest cell.
struct ImageCells {
    double size;  ///< [px]
    int columns, rows;

    ImageCells(double width, double height, double cell_size)
        : size(cell_size),
          columns(static_cast<int>(width / cell_size) + 1),
          rows(static_cast<int>(height / cell_size) + 1) {}

    int column(double x) const { return std::clamp(static_cast<int>(x / size), 0, columns - 1); }
    int row(double y) const { return std::clamp(static_cast<int>(y / size), 0, rows - 1); }
    std::size_t index(int c, int r) const {
        return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns) +
               static_cast<std::size_t>(c);
    }
    std::size_t count() const { return index(0, rows); }
    std::size_t at(Vec2 p) const { return index(column(p.x), row(p.y)); }

    /// Marks the cells in which a point fulfils condition(index), and all their neighbours.
    template <class Condition>
    std::vector<char> around(const std::vector<Vec2>& points, Condition&& condition) const {
        std::vector<char> marked(count(), 0);
        for (std::size_t j = 0; j < points.size(); ++j) {
            if (!condition(j)) continue;
            const int c = column(points[j].x);
            const int r = row(points[j].y);
            for (int y = std::max(0, r - 1); y <= std::min(rows - 1, r + 1); ++y) {
                for (int x = std::max(0, c - 1); x <= std::min(columns - 1, c + 1); ++x) {
                    marked[index(x, y)] = 1;
                }
            }
        }
        return marked;
    }

    /// Calls body(members) for each cell that holds some of `discs`, in parallel, in four rounds:
    /// no two cells of a round are neighbours. Members are in the order of `discs`.
    void in_rounds(const std::vector<Vec2>& positions, const std::vector<std::uint32_t>& discs,
                   int threads,
                   const std::function<void(const std::vector<std::uint32_t>&)>& body) const;
};

}  // namespace grainfield::tracking
