#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"

namespace grainfield::tracking {

/// Points of a board as one picture has them.
struct BoardView {
    std::vector<Vec2> pixel;  ///< [px]
    std::vector<Vec2> place;  ///< on the board, whole numbers [distance of neighbours]
    std::size_t spots = 0;    ///< of dots: all that were found, on the grid or not

    bool empty() const { return pixel.empty(); }
    /// Whether it can be fitted: 9 points, 3 columns and 3 rows or more.
    bool is_usable() const;
    /// Of dots: whether half of what was found lies on the grid. A frame of spheres has grids, too,
    /// but of few of them.
    bool is_most_of_the_picture() const { return 2 * pixel.size() >= spots; }
};

/// Inner corners of a chessboard, to a few hundredths of a pixel (OpenCV findChessboardCornersSB on
/// 8 bit). `columns` × `rows` inner corners; without them the
/// board is taken as large as it is found, three by three at least. What has no squares, bright and
/// dark by turns, is none. Empty: there is none.
BoardView find_chessboard(const Image& counts, const std::vector<std::int64_t>& columns_rows = {});

/// Dots of one size on a square grid, located as spheres are (locate), and the number of all spots
/// that were. Without points: there is no grid.
BoardView find_dots(const Image& counts, int threads);

/// Puts points into the order of a square grid. From the point nearest to their middle the grid is
/// followed from neighbour to neighbour, the next place expected where the last two point to, so
/// that perspective and distortion do no harm while the step changes by less than a fifth from one
/// dot to the next. Points that the grid does not reach, or that are off by more than that, are
/// left out; where two claim a place, both. O(points²).
BoardView grid_order(const std::vector<Vec2>& points);

}  // namespace grainfield::tracking
