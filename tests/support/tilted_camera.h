#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"

namespace grainfield::testing {

/// Where a flat thing is held before the camera.
struct Pose {
    std::array<double, 3> turn{};   ///< about x, then y, then z [rad]
    std::array<double, 3> shift{};  ///< of its origin from the camera [plane unit]
};

/// A pinhole with a lens that distorts, in the words of OpenCV's manual; nothing of the product is
/// used. Planes are seen from above with y down, so that nothing is mirrored.
struct TiltedCamera {
    int width = 640, height = 480;
    double focal = 1200;      ///< [px]
    Vec2 centre{325.5, 236};  ///< [px]
    double k1 = -0.25, k2 = 0.1, p1 = 0.001, p2 = -0.0015;
    /// Edges of discs widen from the middle of the layer to its left and right ends, there by
    /// √(1 + defocus²).
    double defocus = 0;

    /// Where a point of the plane z = 0 is seen [px].
    Vec2 seen(Vec2 place, const Pose& pose) const;
    /// The point of the plane that is seen there, by halving steps of a fixed-point iteration.
    Vec2 place_at(Vec2 pixel, const Pose& pose) const;

    /// A chessboard of `columns` × `rows` inner corners, squares of side 1, first corner at the
    /// origin; blurred by a Gaussian of 0.7 px, grey beside it; noise in counts.
    Image chessboard(int columns, int rows, const Pose& pose, double noise,
                     std::uint64_t seed) const;
    /// Dark discs of this diameter on a bright plane, edges as the tracker has them (tanh, 1.2 px
    /// wide); each is the picture of a disc in the plane.
    Image discs(const std::vector<Vec2>& place, double diameter, const Pose& pose, double noise,
                std::uint64_t seed) const;
    /// A bright cell of these sides, first corner at the origin, between dark walls as thick as
    /// `wall`, dark discs of diameter 1 in it; edges blurred by a Gaussian of 0.8 px.
    Image cell(double width_of_cell, double height_of_cell, double wall,
               const std::vector<Vec2>& place, const Pose& pose, double noise,
               std::uint64_t seed) const;
};

/// A board that is turned so, its middle seen straight ahead at that distance.
Pose held(const std::array<double, 3>& turn, Vec2 middle_of_board, double distance);

/// Boards held in eight ways before that camera, so that their middle is seen about in the middle;
/// the first one lies straight.
std::vector<Pose> board_poses(Vec2 middle_of_board, double distance);

}  // namespace grainfield::testing
