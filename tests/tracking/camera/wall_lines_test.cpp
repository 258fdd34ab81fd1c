#include "tracking/camera/wall_lines.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/tilted_camera.h"
#include "tracking/camera/camera_fit.h"

namespace grainfield::tracking {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::held;
using testing::Pose;
using ::testing::ThrowsMessage;
using testing::TiltedCamera;

constexpr double kWidth = 40, kHeight = 30;  // of the cell, in diameters

TiltedCamera straight_lens() {
    TiltedCamera camera;
    camera.k1 = camera.k2 = camera.p1 = camera.p2 = 0;
    return camera;
}

/// Spheres that also touch the walls.
std::vector<Vec2> spheres() {
    std::vector<Vec2> places;
    for (double y = 0.5; y < kHeight; y += 2.1) {
        for (double x = 0.5 + 0.3 * std::sin(y); x < kWidth - 0.5; x += 1.9) {
            if (x > 0.5) places.push_back({x, y});
        }
    }
    return places;
}

/// The largest distance of a corrected place from where the given sides have it, over the cell.
double largest_error(const TiltedCamera& lens, const Pose& pose, const Camera& camera) {
    const CameraMap map(camera);
    double largest = 0;
    for (double y = 0; y <= kHeight; y += 1) {
        for (double x = 0; x <= kWidth; x += 1) {
            const Vec2 wanted = camera.cell->origin + (1 / camera.scale->length) * Vec2{x, y};
            largest =
                std::max(largest, norm(map.corrected(lens.seen({x, y}, pose)).position - wanted));
        }
    }
    return largest;
}

TEST(WallLines, GiveTheTiltToAFiftiethOfAPixel) {
    const TiltedCamera lens = straight_lens();
    const std::vector<Vec2> place = spheres();
    std::uint64_t seed = 1;
    for (const std::array<double, 3>& turn :
         {std::array{0.0, 0.0, 0.0}, {0.0, 0.0, 0.0}, {0.07, -0.05, 0.02}, {-0.1, 0.12, -0.1}}) {
        const Pose pose = held(turn, {kWidth / 2, kHeight / 2}, 85);
        const Image image = lens.cell(kWidth, kHeight, 1.5, place, pose, 2, seed++);
        const CellWalls walls = find_walls(image);
        const std::array<Vec2, 4> corner{lens.seen({0, 0}, pose), lens.seen({kWidth, 0}, pose),
                                         lens.seen({kWidth, kHeight}, pose),
                                         lens.seen({0, kHeight}, pose)};
        for (std::size_t i = 0; i < corner.size(); ++i) {
            EXPECT_LT(norm(walls.corner[i] - corner[i]), 0.02) << "corner " << i;
        }
        const Camera camera = camera_of_rectangle(walls.corner, kWidth, kHeight,
                                                  PlaneUnit::diameter, lens.width, lens.height);
        const double error = largest_error(lens, pose, camera);
        RecordProperty("largest_error_" + std::to_string(seed), std::to_string(error));
        EXPECT_LT(error, 0.02);
        // One edge point has noise of 2 / √3 counts a pixel under weights of which the squares sum
        // to 2, over 0.66 of the step of 150: 0.016 px.
        EXPECT_LT(walls.residual_rms, 0.02);
    }
}

TEST(WallLines, AreNotDrawnToTheGridOfPixels) {
    // Upright and level walls are at one phase of the grid all along: where that shifts an edge, it
    // shifts a wall. Noise of 1 count, which also spreads the rounding of counts, leaves 0.008 px a
    // point and 0.0015 px at the end of a line of 200; linear interpolation shifts by up to 0.015.
    const TiltedCamera lens = straight_lens();
    std::uint64_t seed = 1;
    for (const double shift : {0.0, 0.01, 0.02, 0.03}) {
        const Pose pose = held({0, 0, 0}, {kWidth / 2 + shift, kHeight / 2 + shift}, 85);
        const CellWalls walls = find_walls(lens.cell(kWidth, kHeight, 1.5, {}, pose, 1, seed++));
        EXPECT_LT(norm(walls.corner[0] - lens.seen({0, 0}, pose)), 0.01) << shift;
        EXPECT_LT(norm(walls.corner[2] - lens.seen({kWidth, kHeight}, pose)), 0.01) << shift;
    }
}

TEST(WallLines, ThatAreNotAllSeenAreNamed) {
    const TiltedCamera lens = straight_lens();
    // The right and the lower wall lie outside of the frame.
    const Pose near = held({0, 0, 0}, {18, 14}, 70);
    const Image cut = lens.cell(60, 50, 1.5, {}, near, 2, 1);
    EXPECT_THAT([&] { find_walls(cut); },
                ThrowsMessage<InputError>(
                    AllOf(HasSubstr("right"), HasSubstr("lower"), HasSubstr("corners"))));
    Image empty(200, 150);
    EXPECT_THAT([&] { find_walls(empty); }, ThrowsMessage<InputError>(HasSubstr("left, upper")));
    // Spheres alone have no straight edges.
    const Image layer = lens.cell(400, 400, 1, spheres(), held({0, 0, 0}, {20, 15}, 85), 2, 1);
    EXPECT_THROW(find_walls(layer), InputError);
}

}  // namespace
}  // namespace grainfield::tracking
