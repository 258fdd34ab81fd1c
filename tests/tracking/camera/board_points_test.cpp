#include "tracking/camera/board_points.h"

#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"
#include "tests/support/tilted_camera.h"

namespace grainfield::tracking {
namespace {

using testing::board_poses;
using testing::Pose;
using testing::TiltedCamera;

/// A camera of few pixels, so that tests are quick.
TiltedCamera small_camera() {
    TiltedCamera camera;
    camera.width = 400;
    camera.height = 300;
    camera.focal = 750;
    camera.centre = {203, 147};
    return camera;
}

std::vector<Vec2> grid_places(int columns, int rows) {
    std::vector<Vec2> places;
    for (int row = 0; row < rows; ++row) {
        for (int column = 0; column < columns; ++column) {
            places.push_back({static_cast<double>(column), static_cast<double>(row)});
        }
    }
    return places;
}

/// Whether places are those of the board up to a shift, a quarter turn or a mirror: neighbours in
/// the picture are neighbours in the order.
void expect_same_grid(const BoardView& view, const TiltedCamera& camera, const Pose& pose,
                      double tolerance) {
    std::set<std::pair<double, double>> seen;
    for (std::size_t i = 0; i < view.pixel.size(); ++i) {
        const Vec2 true_place = camera.place_at(view.pixel[i], pose);
        const Vec2 nearest{std::round(true_place.x), std::round(true_place.y)};
        EXPECT_LT(norm(camera.seen(nearest, pose) - view.pixel[i]), tolerance);
        const auto step = [&](Vec2 a, Vec2 b) { return std::abs(a.x - b.x) + std::abs(a.y - b.y); };
        const Vec2 first = camera.place_at(view.pixel[0], pose);
        EXPECT_NEAR(step(view.place[i], view.place[0]),
                    step(nearest, {std::round(first.x), std::round(first.y)}), 1e-9);
        EXPECT_TRUE(seen.insert({nearest.x, nearest.y}).second);
    }
}

TEST(GridOrder, FollowsAGridThroughPerspectiveAndHoles) {
    const TiltedCamera camera = small_camera();
    const Pose pose = board_poses({7, 5}, 34)[5];
    std::vector<Vec2> points;
    for (const Vec2 place : grid_places(15, 11)) {
        const bool is_hole = place.x == 4 && place.y >= 3 && place.y <= 6;
        if (!is_hole) points.push_back(camera.seen(place, pose));
    }
    points.push_back({391.0, 12.0});  // dirt
    const BoardView view = grid_order(points);
    EXPECT_EQ(view.pixel.size(), 15U * 11U - 4U);
    expect_same_grid(view, camera, pose, 1e-6);
}

TEST(GridOrder, OfTooFewPointsIsEmpty) {
    EXPECT_TRUE(grid_order({}).empty());
    EXPECT_TRUE(grid_order({{1, 1}, {2, 1}}).empty());
    EXPECT_TRUE(grid_order({{1, 1}, {2, 1}, {3, 1}}).empty());
}

TEST(FindChessboard, FindsItsSizeItself) {
    const TiltedCamera camera = small_camera();
    const Pose pose = board_poses({5, 3.5}, 34)[3];
    const Image image = camera.chessboard(11, 8, pose, 2, 1);
    const BoardView found = find_chessboard(image);
    EXPECT_EQ(found.pixel.size(), 88U);
    // Corners in noise of a ninetieth of the contrast: a few hundredths of a pixel.
    expect_same_grid(found, camera, pose, 0.15);
    EXPECT_EQ(find_chessboard(image, {11, 8}).pixel.size(), 88U);
}

TEST(FindChessboard, FindsNoneInAFrameOfSpheres) {
    const auto scene = testing::isolated_discs(200, 150, 10, 16, 1);
    EXPECT_TRUE(find_chessboard(testing::tanh_frame(scene, 9, 1.25, 0.02, 1)).empty());
    EXPECT_TRUE(find_chessboard(testing::noise_frame(200, 150, 100, 10, 0, 1)).empty());
}

TEST(FindDots, LocatesAndOrdersAPlateOfDots) {
    const TiltedCamera camera = small_camera();
    const Pose pose = board_poses({5, 3.5}, 34)[1];
    const BoardView found = find_dots(camera.discs(grid_places(11, 8), 0.4, pose, 2, 1), 1);
    EXPECT_EQ(found.pixel.size(), 88U);
    expect_same_grid(found, camera, pose, 0.1);
    EXPECT_TRUE(find_dots(testing::noise_frame(200, 150, 100, 10, 0, 1), 1).empty());
}

}  // namespace
}  // namespace grainfield::tracking
