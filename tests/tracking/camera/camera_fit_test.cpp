#include "tracking/camera/camera_fit.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/tilted_camera.h"

namespace grainfield::tracking {
namespace {

using testing::board_poses;
using testing::Pose;
using testing::TiltedCamera;

constexpr int kColumns = 13, kRows = 10;
constexpr double kPitch = 5;  // mm
/// What lens and tilt may leave [px].
constexpr double kAccuracy = 0.02;

BoardView exact_view(const TiltedCamera& camera, const Pose& pose) {
    BoardView view;
    for (int row = 0; row < kRows; ++row) {
        for (int column = 0; column < kColumns; ++column) {
            const Vec2 place{static_cast<double>(column), static_cast<double>(row)};
            view.place.push_back(place);
            view.pixel.push_back(camera.seen(place, pose));
        }
    }
    return view;
}

/// Largest distance of corrected points [px] from those of the plane, best rotation and shift
/// taken, the scale as the camera says.
double largest_error(const CameraMap& map, const TiltedCamera& truth, const Pose& pose,
                     double least_place = 0, double last_column = kColumns - 1,
                     double last_row = kRows - 1) {
    const double px = kPitch / map.camera().scale->length;  // of one square
    std::vector<Vec2> found, wanted;
    for (double y = least_place; y <= last_row; y += 0.5) {
        for (double x = least_place; x <= last_column; x += 0.5) {
            found.push_back(map.corrected(truth.seen({x, y}, pose)).position);
            wanted.push_back({x * px, y * px});
        }
    }
    Vec2 mean_found, mean_wanted;
    const double weight = 1.0 / static_cast<double>(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        mean_found += weight * found[i];
        mean_wanted += weight * wanted[i];
    }
    double along = 0, across = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const Vec2 f = found[i] - mean_found;
        const Vec2 w = wanted[i] - mean_wanted;
        along += dot(f, w);
        across += w.x * f.y - w.y * f.x;
    }
    const double angle = std::atan2(across, along);
    double largest = 0;
    for (std::size_t i = 0; i < found.size(); ++i) {
        const Vec2 w = wanted[i] - mean_wanted;
        const Vec2 turned{w.x * std::cos(angle) - w.y * std::sin(angle),
                          w.x * std::sin(angle) + w.y * std::cos(angle)};
        largest = std::max(largest, norm(found[i] - mean_found - turned));
    }
    return largest;
}

TEST(CameraFit, ExactPointsGiveTheLensBack) {
    const TiltedCamera truth;
    std::vector<BoardView> views;
    const auto poses = board_poses({6, 4.5}, 34);
    for (const Pose& pose : poses) views.push_back(exact_view(truth, pose));
    const CameraFit fit = fit_camera(views, 1, truth.width, truth.height, PlaneScale{kPitch});
    const Lens& lens = fit.camera.lens;
    EXPECT_TRUE(fit.is_centre_fitted);
    // Points are rounded to single precision: 3e-5 px.
    EXPECT_NEAR(lens.focal, truth.focal, 0.5);
    EXPECT_NEAR(lens.centre.x, truth.centre.x, 0.3);
    EXPECT_NEAR(lens.centre.y, truth.centre.y, 0.3);
    EXPECT_NEAR(lens.k1, truth.k1, 1e-3);
    EXPECT_NEAR(lens.k2, truth.k2, 2e-2);
    EXPECT_NEAR(lens.p1, truth.p1, 1e-4);
    EXPECT_NEAR(lens.p2, truth.p2, 1e-4);
    EXPECT_LT(fit.camera.residual_rms, 1e-3);
    EXPECT_LT(largest_error(CameraMap(fit.camera), truth, poses[1]), 1e-3);
}

TEST(CameraFit, RenderedChessboardsLeaveLessThanAFiftiethOfAPixel) {
    const TiltedCamera truth;
    std::vector<BoardView> views;
    const auto poses = board_poses({6, 4.5}, 34);
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Image image = truth.chessboard(kColumns, kRows, poses[i], 2, i);
        views.push_back(find_chessboard(image));
        EXPECT_EQ(views.back().pixel.size(), 130U);
    }
    const CameraFit fit = fit_camera(views, 1, truth.width, truth.height, PlaneScale{kPitch});
    const Lens& lens = fit.camera.lens;
    printf("f %g c %g %g k %g %g p %g %g rms %g centre %d\n", lens.focal, lens.centre.x,
           lens.centre.y, lens.k1, lens.k2, lens.p1, lens.p2, fit.camera.residual_rms,
           fit.is_centre_fitted);
    printf("error %g\n", largest_error(CameraMap(fit.camera), truth, poses[1]));
    EXPECT_LT(largest_error(CameraMap(fit.camera), truth, poses[1]), kAccuracy);
}

TEST(CameraFit, OnePictureOfABoardInTheCellIsEnough) {
    TiltedCamera truth;
    const Pose pose = board_poses({6, 4.5}, 34)[0];
    for (double k1 : {0.0, -.25}) {
        truth.k1 = k1;
        const Image image = truth.chessboard(kColumns, kRows, pose, 2, 1);
        const CameraFit fit =
            fit_camera({find_chessboard(image)}, 0, truth.width, truth.height, PlaneScale{kPitch});
        const Lens& lens = fit.camera.lens;
        printf("f %g c %g %g k %g %g p %g %g rms %g centre %d\n", lens.focal, lens.centre.x,
               lens.centre.y, lens.k1, lens.k2, lens.p1, lens.p2, fit.camera.residual_rms,
               fit.is_centre_fitted);
        printf("error %g\n", largest_error(CameraMap(fit.camera), truth, pose));
        EXPECT_LT(largest_error(CameraMap(fit.camera), truth, pose), kAccuracy);
    }
}

TEST(CameraFit, DotsLocatedByTheTrackerLeaveLessThanAFiftiethOfAPixel) {
    const TiltedCamera truth;
    std::vector<BoardView> views;
    const auto poses = board_poses({6, 4.5}, 34);
    std::vector<Vec2> dots;
    for (int row = 0; row < kRows; ++row) {
        for (int column = 0; column < kColumns; ++column)
            dots.push_back({double(column), double(row)});
    }
    for (std::size_t i = 0; i < poses.size(); ++i) {
        const Image image = truth.discs(dots, 0.4, poses[i], 2, i);
        views.push_back(find_dots(image, 1));
        EXPECT_EQ(views.back().pixel.size(), 130U);
    }
    const CameraFit fit = fit_camera(views, 1, truth.width, truth.height, PlaneScale{kPitch});
    const Lens& lens = fit.camera.lens;
    printf("f %g c %g %g k %g %g p %g %g rms %g centre %d\n", lens.focal, lens.centre.x,
           lens.centre.y, lens.k1, lens.k2, lens.p1, lens.p2, fit.camera.residual_rms,
           fit.is_centre_fitted);
    printf("error %g\n", largest_error(CameraMap(fit.camera), truth, poses[1]));
    EXPECT_LT(largest_error(CameraMap(fit.camera), truth, poses[1]), kAccuracy);
}

}  // namespace
}  // namespace grainfield::tracking
