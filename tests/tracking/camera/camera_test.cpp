#include "tracking/camera/camera.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/calib3d.hpp>

#include "core/errors.h"

namespace grainfield::tracking {
namespace {

using ::testing::HasSubstr;

Camera lens_only() {
    Camera camera;
    camera.width = 640;
    camera.height = 480;
    camera.lens = {
        .focal = 1200, .centre = {325.5, 236}, .k1 = -0.25, .k2 = 0.1, .p1 = 0.001, .p2 = -0.0015};
    return camera;
}

Camera tilted() {
    Camera camera = lens_only();
    camera.homography = {1.02, 0.03, -8, -0.02, 0.98, 11, 4e-5, -6e-5, 1};
    return camera;
}

/// Points of the whole frame, its sides included.
std::vector<Vec2> points() {
    std::vector<Vec2> all;
    for (double y = -0.5; y <= 479.5; y += 30) {
        for (double x = -0.5; x <= 639.5; x += 32) all.push_back({x, y});
    }
    return all;
}

TEST(CameraMap, DistortionIsThatOfOpenCV) {
    const CameraMap map(lens_only());
    const Lens& lens = map.camera().lens;
    const cv::Matx33d matrix(lens.focal, 0, lens.centre.x, 0, lens.focal, lens.centre.y, 0, 0, 1);
    const cv::Vec4d distortion(lens.k1, lens.k2, lens.p1, lens.p2);
    std::vector<cv::Point2d> seen;
    std::vector<cv::Point2d> ideal;
    for (const Vec2 p : points()) seen.emplace_back(p.x, p.y);
    cv::undistortPoints(seen, ideal, matrix, distortion, cv::noArray(), matrix,
                        {cv::TermCriteria::COUNT, 100, 0});
    double largest = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const Vec2 own = map.corrected({seen[i].x, seen[i].y}).position;
        largest = std::max(largest, norm(own - Vec2{ideal[i].x, ideal[i].y}));
    }
    EXPECT_LT(largest, 1e-8);
    // The correction is far from nothing: the comparison means something.
    EXPECT_GT(norm(map.corrected({0, 0}).position), 10);
}

TEST(CameraMap, ThereAndBackIsTheSamePoint) {
    const CameraMap map(tilted());
    for (const Vec2 p : points()) {
        EXPECT_LT(norm(map.in_picture(map.corrected(p).position) - p), 1e-9);
    }
}

TEST(CameraMap, TheJacobianIsTheSlopeOfTheMap) {
    const CameraMap map(tilted());
    constexpr double h = 1e-3;
    for (const Vec2 p : points()) {
        const auto slope = [&](Vec2 step) {
            return (0.5 / h) *
                   (map.corrected(p + h * step).position - map.corrected(p - h * step).position);
        };
        const CameraMap::Jacobian j = map.corrected(p).jacobian;
        const Vec2 along_x = slope({1, 0});
        const Vec2 along_y = slope({0, 1});
        // Central differences: h² times third derivatives (1e-6 px⁻²), and 1e-10/h of the solver.
        EXPECT_NEAR(j.xx, along_x.x, 3e-7);
        EXPECT_NEAR(j.yx, along_x.y, 3e-7);
        EXPECT_NEAR(j.xy, along_y.x, 3e-7);
        EXPECT_NEAR(j.yy, along_y.y, 3e-7);
    }
}

TEST(CameraMap, ErrorsGrowAsTheMapStretches) {
    Camera camera;
    camera.width = camera.height = 100;
    camera.homography = {2, 0, 0, 1, 3, 0, 0, 0, 1};  // x' = 2x, y' = x + 3y
    Snapshot snapshot;
    snapshot.position = {{10, 20}};
    snapshot.position_error = {{0.4, 0.1}};
    CameraMap(camera).correct(snapshot);
    EXPECT_EQ(snapshot.position[0], (Vec2{20, 70}));
    EXPECT_DOUBLE_EQ(snapshot.position_error[0].x, 0.8);
    EXPECT_DOUBLE_EQ(snapshot.position_error[0].y, 0.5);
}

TEST(CameraMap, OfARegionCountsFromItsCorner) {
    const Camera camera = tilted();
    const Vec2 origin{100, 50};
    const CameraMap whole(camera);
    const CameraMap region(camera, origin);
    const Vec2 p{17.25, 33.5};
    const Vec2 corrected = region.corrected(p).position;
    EXPECT_LT(norm(corrected + origin - whole.corrected(p + origin).position), 1e-12);
    EXPECT_LT(norm(region.in_picture(corrected) - p), 1e-9);
}

TEST(CameraMap, TheBoxIsTheRectangleOfWhichAllWasSeen) {
    const CameraMap map(tilted());
    const Box box = map.box(640, 480);
    const Vec2 end = box.origin + box.length;
    const auto beside = [&](Vec2 corrected) {
        const Vec2 p = map.in_picture(corrected);
        return std::max({-0.5 - p.x, -0.5 - p.y, p.x - 639.5, p.y - 479.5});
    };
    // Each side touches a side of the frame, and none leaves it.
    double left = -1e9, right = -1e9, top = -1e9, bottom = -1e9;
    for (int i = 0; i <= 1000; ++i) {
        const double x = box.origin.x + 1e-3 * i * box.length.x;
        const double y = box.origin.y + 1e-3 * i * box.length.y;
        left = std::max(left, beside({box.origin.x, y}));
        right = std::max(right, beside({end.x, y}));
        top = std::max(top, beside({x, box.origin.y}));
        bottom = std::max(bottom, beside({x, end.y}));
    }
    for (const double side : {left, right, top, bottom}) EXPECT_LT(side, 0.01);
    EXPECT_GT(box.area(), 0.85 * 640 * 480);
}

TEST(CameraMap, WallsThatAreSeenAreTheBox) {
    Camera camera = tilted();
    Box cell;
    cell.origin = {100, 90};
    cell.length = {400, 300};
    camera.cell = cell;
    const Box box = CameraMap(camera).box(640, 480);
    EXPECT_EQ(box.origin, cell.origin);
    EXPECT_EQ(box.length, cell.length);
    // Of a region that leaves out its right half, the part that is seen.
    const Box part = CameraMap(camera).box(320, 480);
    EXPECT_EQ(part.origin, cell.origin);
    EXPECT_LT(part.length.x, 250);
    EXPECT_EQ(part.length.y, cell.length.y);
}

TEST(CameraMap, AMapThatFoldsThePictureOverIsRefused) {
    Camera folded = lens_only();
    folded.lens.k1 = -8;
    EXPECT_THAT(fault_of(folded), HasSubstr("folds"));
    EXPECT_THROW(CameraMap{folded}, InputError);
    Camera flat = lens_only();
    flat.homography = {1, 0, 0, 1, 0, 0, 0, 0, 1};
    EXPECT_THAT(fault_of(flat), HasSubstr("folds"));
    Camera beyond = lens_only();
    beyond.homography[6] = -1.0 / 300;  // the horizon crosses the frame
    EXPECT_THAT(fault_of(beyond), HasSubstr("folds"));
    EXPECT_EQ(fault_of(tilted()), "");
}

TEST(Camera, OfAnotherSizeIsRefusedWithBoth) {
    try {
        tilted().require_size(1600, 1200, "film.avi");
        FAIL() << "was taken";
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), HasSubstr("'film.avi' has 1600 x 1200 px"));
        EXPECT_THAT(error.what(), HasSubstr("640 x 480 px"));
    }
}

TEST(Camera, ItsScaleTellsTheDiameterOfTheSpheres) {
    Camera camera = tilted();
    EXPECT_FALSE(camera.diameter_px(1.0));
    camera.scale = PlaneScale{0.05, PlaneUnit::mm};
    EXPECT_FALSE(camera.diameter_px({}));
    EXPECT_DOUBLE_EQ(*camera.diameter_px(1.0), 20);
    camera.scale = PlaneScale{0.1, PlaneUnit::diameter};
    EXPECT_DOUBLE_EQ(*camera.diameter_px({}), 10);
}

TEST(CorrectedPictures, ShowAtACorrectedPlaceWhatWasSeenThere) {
    // Brightness is a plane: linear interpolation is exact.
    Image frame(640, 480);
    for (int y = 0; y < 480; ++y) {
        for (int x = 0; x < 640; ++x) frame(x, y) = static_cast<float>(0.25 * x + 0.125 * y);
    }
    const CameraMap map(tilted());
    const Image picture = CorrectedPictures(map, 640, 480)(frame);
    for (const Vec2 p : {Vec2{320, 240}, Vec2{200, 100}, Vec2{500, 400}}) {
        const Vec2 seen = map.in_picture(p);
        // OpenCV takes the place to 1/32 px.
        EXPECT_NEAR(picture(static_cast<int>(p.x), static_cast<int>(p.y)),
                    0.25 * seen.x + 0.125 * seen.y, 0.375 / 32);
    }
}

}  // namespace
}  // namespace grainfield::tracking
