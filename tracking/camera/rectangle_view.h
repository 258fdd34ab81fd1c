#pragma once

#include <array>

#include "core/vec2.h"

namespace grainfield::tracking {

/// How a rectangle must lie before a camera to be seen with given corners.
struct RectangleView {
    double misfit = 0;  ///< of the corners, RMS distance [px]
    double tilt = 0;    ///< between its normal and the line of sight to its middle [°]
    double doubt = 0;   ///< (misfit / 0.3 % of the longer side of the frame)² + (tilt / 15°)²

    /// Whether a usual camera may see it so: 1 % and 35° at most.
    bool is_likely = false;
};

/// The likeliest view of a rectangle with these sides: that of least doubt.
///
/// Four corners are eight numbers. A camera with square pixels that looks through the middle of its
/// frame has seven: the pose and the focal length. So sides that are wrong leave a misfit, or, as
/// the focal length may compensate for them, a tilt that no camera over a cell has. For 40 focal
/// lengths from 0.5 to 20 times the longer side of the frame the pose is fitted by least squared
/// distances of the corners (OpenCV solvePnPGeneric, IPPE, then Levenberg–Marquardt).
///
/// `corner`: in order around it [px]; `first_side`: from the first to the second corner,
/// `second_side`: from there to the third, in one unit.
RectangleView rectangle_view(const std::array<Vec2, 4>& corner, double first_side,
                             double second_side, int width, int height);

}  // namespace grainfield::tracking
