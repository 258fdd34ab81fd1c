#include "tracking/camera/rectangle_view.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/tilted_camera.h"

namespace grainfield::tracking {
namespace {

using testing::held;
using testing::Pose;
using testing::TiltedCamera;

constexpr double kDegree = 3.14159265358979 / 180;

/// Looks through a point 1 % beside the middle of its frame, as cameras do.
TiltedCamera straight_lens() {
    TiltedCamera camera;
    camera.k1 = camera.k2 = camera.p1 = camera.p2 = 0;
    return camera;
}

std::array<Vec2, 4> corners_of(const TiltedCamera& camera, double width, double height,
                               const Pose& pose) {
    std::array<Vec2, 4> corner;
    std::ranges::transform(
        std::array{Vec2{0, 0}, Vec2{width, 0}, Vec2{width, height}, Vec2{0, height}},
        corner.begin(), [&](Vec2 place) { return camera.seen(place, pose); });
    return corner;
}

/// A rectangle of 40 wide that fills most of the frame.
struct Seen {
    std::array<Vec2, 4> corner;
    double width, height;

    RectangleView as_it_is() const { return rectangle_view(corner, width, height, 640, 480); }
    RectangleView swapped() const { return rectangle_view(corner, height, width, 640, 480); }
};

Seen seen(double height, const std::array<double, 3>& turn) {
    const TiltedCamera camera = straight_lens();
    return {corners_of(camera, 40, height, held(turn, {20, height / 2}, 85)), 40, height};
}

/// Straight, about one axis, about both, and turned in the plane.
std::vector<std::array<double, 3>> turns() {
    return {{0, 0, 0},
            {5 * kDegree, 0, 0},
            {0, -5 * kDegree, 0},
            {12 * kDegree, -9 * kDegree, 3 * kDegree},
            {-20 * kDegree, 0, 0},
            {0, 25 * kDegree, 0}};
}

TEST(RectangleView, OfTrueSidesIsTheTiltWithoutMisfit) {
    for (const auto& turn : turns()) {
        const RectangleView view = seen(30, turn).as_it_is();
        const double tilt = std::acos(std::cos(turn[0]) * std::cos(turn[1])) / kDegree;
        // The camera looks 6.4 px beside the middle, and focal lengths are a tenth apart.
        EXPECT_LT(view.misfit, 0.5) << turn[0] << ", " << turn[1];
        EXPECT_NEAR(view.tilt, tilt, 3) << turn[0] << ", " << turn[1];
        EXPECT_TRUE(view.is_likely);
    }
}

// calibrate-camera refuses sides that are 9 worse than the swapped ones, and warns from 2 on.
TEST(RectangleView, OfSwappedSidesIsMoreDoubtfulTheMoreTheyDiffer) {
    for (const double height : {20.0, 25.0, 30.0, 34.0, 36.0}) {
        for (const auto& turn : turns()) {
            const Seen rectangle = seen(height, turn);
            EXPECT_GT(rectangle.swapped().doubt - rectangle.as_it_is().doubt, height > 30 ? 2 : 9)
                << height << " high, " << turn[0] << ", " << turn[1];
            EXPECT_TRUE(rectangle.as_it_is().is_likely);
        }
    }
}

TEST(RectangleView, OfTrueSidesIsNotWarnedOf) {
    for (const double height : {20.0, 30.0, 36.0, 39.0, 40.0}) {
        for (const auto& turn : turns()) {
            const Seen rectangle = seen(height, turn);
            EXPECT_LT(rectangle.as_it_is().doubt - rectangle.swapped().doubt, 2)
                << height << " high, " << turn[0] << ", " << turn[1];
        }
    }
}

TEST(RectangleView, IsTheSameFromAnyCornerAndAroundTheOtherWay) {
    const Seen rectangle = seen(30, {12 * kDegree, -9 * kDegree, 3 * kDegree});
    const auto& c = rectangle.corner;
    const RectangleView view = rectangle.as_it_is();
    const RectangleView next = rectangle_view({c[1], c[2], c[3], c[0]}, 30, 40, 640, 480);
    const RectangleView back = rectangle_view({c[0], c[3], c[2], c[1]}, 30, 40, 640, 480);
    EXPECT_NEAR(next.doubt, view.doubt, 1e-3);
    EXPECT_NEAR(back.doubt, view.doubt, 1e-3);
}

}  // namespace
}  // namespace grainfield::tracking
