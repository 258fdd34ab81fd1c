#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/vec2.h"
#include "tracking/camera/board_points.h"
#include "tracking/camera/camera.h"

namespace grainfield::tracking {

/// Where a point is seen and where the fitted camera has it.
struct BoardResidual {
    std::size_t view = 0;
    Vec2 pixel;     ///< as found [px]
    Vec2 residual;  ///< found − fitted [px]
};

struct CameraFit {
    Camera camera;
    std::vector<BoardResidual> residuals;
    bool is_centre_fitted = false;  ///< else the middle of the frame
    /// Radius that the points reach, as a share of the distance of the frame's corners.
    double reach = 0;
    double pitch = 0;          ///< distance of neighbours in the middle of the cell's picture [px]
    std::int64_t dropped = 0;  ///< points left out as wrong
};

/// Fits lens and tilt to the pictures of a board.
///
/// Lens: focal length (square pixels), centre, k1, k2, p1 and p2 of all views together, by least
/// squared distances in the picture (OpenCV calibrateCamera, Levenberg–Marquardt to a change of
/// 1e-12 or 300 iterations, best of three starts). The centre is that of the frame unless three
/// views or more tell it to within 1 % of the frame's width, or one of its own within 15 % of the
/// width of the middle lowers the squares by far more than chance. Tilt: the homography of view
/// `cell_view`, whose board lies in the plane of the cell, to the undistorted points (OpenCV
/// findHomography). Views whose median distance is more than 2.5 times that of all are left out,
/// then points at more than five times the median, and all is fitted again.
///
/// `pitch`: distance of neighbours on the board; empty: the scale is not known. Throws InputError
/// for a view with fewer than 9 points or none across, and where no map fits (fault_of).
CameraFit fit_camera(const std::vector<BoardView>& views, std::size_t cell_view, int width,
                     int height, const std::optional<PlaneScale>& pitch);

/// Tilt alone, from the corners of a rectangle in the plane of the cell, in order around it [px],
/// and its sides from the first to the second and from there to the third corner. The rectangle is
/// taken for the walls of the cell: its sides come to lie along x and y. Throws OptionError for
/// corners that are no convex quadrilateral.
Camera camera_of_rectangle(const std::array<Vec2, 4>& corners, double first_side,
                           double second_side, const std::optional<PlaneUnit>& unit, int width,
                           int height);

}  // namespace grainfield::tracking
