#pragma once

#include <array>

#include "core/frame.h"
#include "core/vec2.h"

namespace grainfield::tracking {

/// The walls of a cell as a frame shows them.
struct CellWalls {
    std::array<Vec2, 4> corner;  ///< left top, right top, right bottom, left bottom [px]
    double residual_rms = 0;     ///< of the edge points about their straight lines [px]
    int points = 0;              ///< of all four lines
};

/// Finds the four straight edges about the cell: the left and the right one within 30° of upright,
/// the upper and the lower one within 30° of level, the middle of the frame between them.
///
/// Segments of OpenCV's LineSegmentDetector that lie on one line make a candidate; they must cover
/// a quarter of the frame. Of several the innermost is taken whose edge points are within 0.5 px
/// (RMS) of a straight line, which those of a row of spheres are not. Along it every second pixel
/// gives one point: the middle of the slope of the profile across, ±4 px wide, weighted by a
/// Gaussian of 1.5 px about that middle. Lines are fitted to the points by least squares, those off
/// by more than three median deviations left out, five times over. Throws InputError, naming the
/// walls that are not seen, for a frame without all four.
CellWalls find_walls(const Image& image);

}  // namespace grainfield::tracking
