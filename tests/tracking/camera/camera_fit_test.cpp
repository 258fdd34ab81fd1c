#include "tracking/camera/camera_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

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

std::vector<Pose> poses() {
    return board_poses({6, 4.5}, 34);
}

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
double largest_error(const Camera& camera, const TiltedCamera& truth, const Pose& pose) {
    const CameraMap map(camera);
    const double px = kPitch / camera.scale->length;  // of one square
    std::vector<Vec2> found;
    std::vector<Vec2> wanted;
    for (double y = 0; y <= kRows - 1; y += 0.5) {
        for (double x = 0; x <= kColumns - 1; x += 0.5) {
            found.push_back(map.corrected(truth.seen({x, y}, pose)).position);
            wanted.push_back({x * px, y * px});
        }
    }
    Vec2 mean_found;
    Vec2 mean_wanted;
    const double weight = 1.0 / static_cast<double>(found.size());
    for (std::size_t i = 0; i < found.size(); ++i) {
        mean_found += weight * found[i];
        mean_wanted += weight * wanted[i];
    }
    double along = 0;
    double across = 0;
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
    for (const Pose& pose : poses()) views.push_back(exact_view(truth, pose));
    const CameraFit fit = fit_camera(views, 1, truth.width, truth.height, PlaneScale{kPitch});
    const Lens& lens = fit.camera.lens;
    EXPECT_TRUE(fit.is_centre_fitted);
    EXPECT_EQ(fit.dropped, 0);
    // Points are rounded to single precision, 3e-5 px; the worst of these numbers is known a
    // thousand times less well.
    EXPECT_NEAR(lens.focal, truth.focal, 0.1);
    EXPECT_NEAR(lens.centre.x, truth.centre.x, 0.1);
    EXPECT_NEAR(lens.centre.y, truth.centre.y, 0.1);
    EXPECT_NEAR(lens.k1, truth.k1, 1e-3);
    EXPECT_NEAR(lens.k2, truth.k2, 2e-2);
    EXPECT_NEAR(lens.p1, truth.p1, 1e-4);
    EXPECT_NEAR(lens.p2, truth.p2, 1e-4);
    EXPECT_LT(fit.camera.residual_rms, 1e-4);
    EXPECT_LT(largest_error(fit.camera, truth, poses()[1]), 1e-3);
}

TEST(CameraFit, RenderedChessboardsLeaveLessThanAFiftiethOfAPixel) {
    const TiltedCamera truth;
    std::vector<BoardView> views;
    for (std::size_t i = 0; i < 3; ++i) {
        views.push_back(find_chessboard(truth.chessboard(kColumns, kRows, poses()[i], 2, i)));
        EXPECT_EQ(views.back().pixel.size(), 130U);
    }
    const CameraFit fit = fit_camera(views, 1, truth.width, truth.height, PlaneScale{kPitch});
    RecordProperty("largest_error_px",
                   std::to_string(largest_error(fit.camera, truth, poses()[1])));
    EXPECT_LT(largest_error(fit.camera, truth, poses()[1]), kAccuracy);
    EXPECT_LT(fit.camera.residual_rms, 0.03);
}

TEST(CameraFit, DotsLocatedByTheTrackerLeaveLessThanAFiftiethOfAPixel) {
    const TiltedCamera truth;
    std::vector<BoardView> views;
    for (std::size_t i = 0; i < 3; ++i) {
        views.push_back(
            find_dots(truth.discs(exact_view(truth, poses()[i]).place, 0.4, poses()[i], 2, i), 1));
        EXPECT_EQ(views.back().pixel.size(), 130U);
    }
    const CameraFit fit = fit_camera(views, 1, truth.width, truth.height, PlaneScale{kPitch});
    EXPECT_LT(largest_error(fit.camera, truth, poses()[1]), kAccuracy);
}

TEST(CameraFit, OnePictureOfABoardThatLiesStraightIsEnough) {
    // It does not tell the focal length, and the map does not need it.
    for (const double k1 : {0.0, -0.25}) {
        TiltedCamera truth;
        truth.k1 = k1;
        const CameraFit fit = fit_camera({exact_view(truth, poses()[0])}, 0, truth.width,
                                         truth.height, PlaneScale{kPitch});
        EXPECT_LT(largest_error(fit.camera, truth, poses()[0]), kAccuracy);
    }
}

TEST(CameraFit, OneObliquePictureIsEnoughThoughTheCentreIsNotThatOfTheFrame) {
    // 23° from straight; the lens is centred 7 px beside the middle of the frame.
    const TiltedCamera truth;
    const auto error_of = [&](const BoardView& view) {
        const CameraFit fit = fit_camera({view}, 0, truth.width, truth.height, PlaneScale{kPitch});
        EXPECT_TRUE(fit.is_centre_fitted);
        return largest_error(fit.camera, truth, poses()[1]);
    };
    for (const std::uint64_t seed : {1U, 2U}) {
        EXPECT_LT(error_of(find_chessboard(truth.chessboard(kColumns, kRows, poses()[1], 2, seed))),
                  kAccuracy);
    }
    EXPECT_LT(error_of(find_dots(
                  truth.discs(exact_view(truth, poses()[1]).place, 0.4, poses()[1], 2, 1), 1)),
              kAccuracy);
    // Where it is, nothing is won by looking for it elsewhere.
    TiltedCamera centred = truth;
    centred.centre = {319.5, 239.5};
    const CameraFit fit =
        fit_camera({find_chessboard(centred.chessboard(kColumns, kRows, poses()[1], 2, 1))}, 0,
                   truth.width, truth.height, PlaneScale{kPitch});
    EXPECT_FALSE(fit.is_centre_fitted);
}

TEST(CameraFit, TheScaleIsThatOfTheBoard) {
    const TiltedCamera truth;
    const Pose pose = poses()[0];
    const CameraFit fit =
        fit_camera({exact_view(truth, pose)}, 0, truth.width, truth.height, PlaneScale{kPitch});
    // Straight on, in the middle: focal/distance px a square, less what the distortion takes.
    const Vec2 middle{0.5 * (truth.width - 1), 0.5 * (truth.height - 1)};
    const double square = norm(truth.place_at(middle + Vec2{0.5, 0}, pose) -
                               truth.place_at(middle - Vec2{0.5, 0}, pose));
    EXPECT_NEAR(fit.camera.scale->length, kPitch * square, 1e-4 * kPitch * square);
    EXPECT_LT(norm(CameraMap(fit.camera).corrected(middle).position - middle), 1e-9);
}

TEST(CameraFit, AViewWhoseCornersHaveWrongPlacesIsLeftOut) {
    const TiltedCamera truth;
    std::vector<BoardView> views;
    for (std::size_t i = 0; i < 5; ++i) views.push_back(exact_view(truth, poses()[i]));
    for (std::size_t i = 0; i < views[3].place.size(); i += 3) views[3].place[i].x += 1;
    views[0].pixel[7] += Vec2{2, -1};
    const CameraFit fit = fit_camera(views, 1, truth.width, truth.height, PlaneScale{kPitch});
    // A point that is two pixels off takes some of its neighbours with it.
    EXPECT_GE(fit.dropped, 131);
    EXPECT_LT(fit.dropped, 150);
    EXPECT_LT(largest_error(fit.camera, truth, poses()[1]), 1e-3);
}

TEST(CameraFit, TheOrderOfTheCornersMayBeMirrored) {
    const TiltedCamera truth;
    std::vector<BoardView> views;
    for (std::size_t i = 0; i < 4; ++i) views.push_back(exact_view(truth, poses()[i]));
    for (Vec2& p : views[1].place) p.x = kColumns - 1 - p.x;
    const CameraFit fit = fit_camera(views, 1, truth.width, truth.height, PlaneScale{kPitch});
    EXPECT_LT(largest_error(fit.camera, truth, poses()[1]), 1e-3);
}

TEST(CameraFit, TooLittleOfABoardIsRefused) {
    BoardView line;
    for (int i = 0; i < 20; ++i) {
        line.pixel.push_back({10.0 * i, 20.0});
        line.place.push_back({static_cast<double>(i), 0});
    }
    EXPECT_THROW(fit_camera({line}, 0, 640, 480, {}), InputError);
    EXPECT_THROW(fit_camera({BoardView{}}, 0, 640, 480, {}), InputError);
}

TEST(CameraOfRectangle, MakesItsSidesStraightAndOfTheirLengths) {
    TiltedCamera truth;
    truth.k1 = truth.k2 = truth.p1 = truth.p2 = 0;
    const Pose pose = poses()[5];
    const std::array<Vec2, 4> places{Vec2{0, 0}, Vec2{12, 0}, Vec2{12, 9}, Vec2{0, 9}};
    std::array<Vec2, 4> corners;
    std::ranges::transform(places, corners.begin(),
                           [&](Vec2 place) { return truth.seen(place, pose); });
    const Camera camera =
        camera_of_rectangle(corners, 60, 45, PlaneUnit::mm, truth.width, truth.height);
    const double px = 1 / camera.scale->length;  // of a millimetre
    EXPECT_NEAR(camera.cell->length.x, 60 * px, 1e-9);
    EXPECT_NEAR(camera.cell->length.y, 45 * px, 1e-9);
    const CameraMap map(camera);
    for (double y = 0; y <= 9; y += 1.5) {
        for (double x = 0; x <= 12; x += 1.5) {
            const Vec2 wanted = camera.cell->origin + 5 * px * Vec2{x, y};
            // Corners are rounded to single precision.
            EXPECT_LT(norm(map.corrected(truth.seen({x, y}, pose)).position - wanted), 1e-3);
        }
    }
    // From another corner, and around the other way, it is the same.
    const Camera turned = camera_of_rectangle({corners[2], corners[1], corners[0], corners[3]}, 45,
                                              60, PlaneUnit::mm, truth.width, truth.height);
    EXPECT_NEAR(turned.cell->length.x, camera.cell->length.x, 1e-3);
    EXPECT_NEAR(turned.cell->origin.x, camera.cell->origin.x, 1e-3);
    EXPECT_NEAR(turned.scale->length, camera.scale->length, 1e-6);
}

TEST(CameraOfRectangle, CornersThatCrossAreRefused) {
    EXPECT_THROW(camera_of_rectangle({Vec2{0, 0}, Vec2{100, 80}, Vec2{100, 0}, Vec2{0, 80}}, 60, 45,
                                     PlaneUnit::mm, 640, 480),
                 OptionError);
}

}  // namespace
}  // namespace grainfield::tracking
