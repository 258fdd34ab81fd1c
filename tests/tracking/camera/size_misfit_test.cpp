#include "tracking/camera/size_misfit.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/memory_frames.h"
#include "core/support/random.h"
#include "tests/support/layer_frames.h"
#include "tests/support/tilted_camera.h"
#include "tracking/camera/camera_fit.h"
#include "tracking/locate.h"
#include "tracking/synthesis/corrected_positions.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {
namespace {

constexpr double kNarrow = 1e-3;  // discs that nobody is near [px]

/// Seen smaller the farther to the right.
CameraMap tilted() {
    Camera camera;
    camera.width = 600;
    camera.height = 400;
    camera.lens.focal = 1000;
    camera.lens.centre = {299.5, 199.5};
    camera.homography = {1, 0, 0, 0, 1, 0, -2e-4, 0, 1};
    return CameraMap(camera);
}

double size_at(const CameraMap& map, Vec2 p) {
    return 1 / std::sqrt(map.corrected(p).jacobian.determinant());
}

struct Frame {
    std::vector<Vec2> position;
    std::vector<double> residual;
};

Frame frame(const CameraMap& map, int discs, double of_size) {
    RandomStream random(1, "size misfit");
    Frame frame;
    const double usual = size_at(map, {300, 200});
    for (int i = 0; i < discs; ++i) {
        const Vec2 p{600 * random.uniform(), 400 * random.uniform()};
        const double off = of_size * (size_at(map, p) / usual - 1);
        frame.position.push_back(p);
        frame.residual.push_back(std::sqrt(1e-4 * (0.9 + 0.2 * random.uniform()) + off * off));
    }
    return frame;
}

TEST(SizeMisfit, IsWhatDiscsOfAnotherSizeAddToTheResidual) {
    const CameraMap map = tilted();
    const Frame seen = frame(map, 1000, 0.5);
    const std::vector<double> share = size_misfit(map, seen.position, seen.residual, kNarrow);
    const double usual = size_at(map, {300, 200});
    double largest = 0;
    for (std::size_t i = 0; i < share.size(); ++i) {
        const double off = 0.5 * (size_at(map, seen.position[i]) / usual - 1);
        EXPECT_NEAR(share[i], off * off, 3e-5);
        largest = std::max(largest, share[i]);
    }
    EXPECT_GT(largest, 5e-4) << "several times the residual of the others";
}

TEST(SizeMisfit, IsNothingWhereSizeChangesNothing) {
    const CameraMap map = tilted();
    const Frame seen = frame(map, 1000, 0);
    for (const double share : size_misfit(map, seen.position, seen.residual, kNarrow)) {
        EXPECT_LT(share, 1e-5);
    }
    const Frame few = frame(map, 50, 0.5);
    for (const double share : size_misfit(map, few.position, few.residual, kNarrow))
        EXPECT_EQ(share, 0);
}

TEST(SizeMisfit, IsNothingForDiscsThatOverlap) {
    const CameraMap map = tilted();
    Frame seen = frame(map, 1000, 0.5);
    // Each of the last hundred beside one of the first.
    for (std::size_t i = 0; i < 100; ++i) {
        seen.position[900 + i] = seen.position[i] + Vec2{0.5 * kNarrow, 0};
    }
    const std::vector<double> share = size_misfit(map, seen.position, seen.residual, kNarrow);
    EXPECT_GT(*std::max_element(share.begin() + 100, share.begin() + 900), 5e-4);
    for (std::size_t i = 0; i < 100; ++i) {
        EXPECT_EQ(share[i], 0);
        EXPECT_EQ(share[900 + i], 0);
    }
    for (const double s : size_misfit(map, seen.position, seen.residual)) EXPECT_EQ(s, 0);
}

/// One frame of a layer before a camera that is tilted by 12 degrees.
struct TiltedLayer {
    double apart = 12;   ///< least distance of two spheres, in the unit of the plane
    double area = 0.45;  ///< share of the plane that discs as wide as that cover
    double defocus = 0;  ///< testing::TiltedCamera::defocus

    /// RMS of the errors of positions over that of those reported, discs as wide as 10.
    double pull() const;
};

constexpr double kWide = 10;
constexpr double kLevels = 2;  // noise [counts]

CameraMap map_of(const testing::TiltedCamera& truth, const testing::Pose& cell) {
    constexpr Vec2 middle{280, 220};
    constexpr double pitch = 36;
    std::vector<Vec2> dots;
    for (double y = -20; y < 470; y += pitch) {
        for (double x = -20; x < 590; x += pitch) dots.push_back({x, y});
    }
    std::vector<BoardView> views;
    for (const testing::Pose& pose : {cell, testing::held({0.35, 0, 0}, middle, 1170),
                                      testing::held({-0.1, 0.35, 0.3}, middle, 1080)}) {
        views.push_back(find_dots(truth.discs(dots, 11, pose, kLevels, 1), 1));
    }
    return CameraMap(fit_camera(views, 0, truth.width, truth.height, PlaneScale{pitch}).camera);
}

double TiltedLayer::pull() const {
    testing::TiltedCamera truth{.width = 480, .height = 360, .focal = 900, .centre = {243.5, 176}};
    const testing::Pose cell = testing::held({0.06, -0.2, 0.02}, {280, 220}, truth.focal);
    const CameraMap map = map_of(truth, cell);
    truth.defocus = defocus;
    const std::vector<Vec2> layer = testing::hard_disc_liquid(560, 440, apart, area, 3).position;
    const Image picture = truth.discs(layer, kWide, cell, kLevels, 11);
    MemoryFrames frames({picture});
    TrackOptions options;
    options.threads = 1;
    RunPlan plan;
    const Tracker tracker(frames, options, plan);
    Locator locator(picture.width(), picture.height(), tracker.model(), 1);
    const Located found =
        locator.locate(tracker.model().darkness(picture), options.detection, options.refinement);
    const std::vector<Vec2> errors = standard_errors(
        found,
        size_misfit(map, found.position, found.edge_residual, tracker.model().disc.diameter));
    double square = 0;
    double reported = 0;
    int count = 0;
    for (const Vec2 place : layer) {
        const Vec2 wanted = truth.seen(place, cell);
        if (wanted.x < 20 || wanted.y < 20 || wanted.x > 460 || wanted.y > 340) continue;
        const auto nearest = std::ranges::min_element(
            found.position, {}, [&](Vec2 p) { return squared_norm(p - wanted); });
        if (squared_norm(*nearest - wanted) > 1) continue;
        square += squared_norm(*nearest - wanted);
        reported +=
            squared_norm(errors[static_cast<std::size_t>(nearest - found.position.begin())]);
        ++count;
    }
    EXPECT_GT(count, 250);
    return std::sqrt(square / reported);
}

TEST(SizeMisfit, LeavesErrorsOfDenseTiltedLayersLargeEnough) {
    const double overlapping = TiltedLayer{.apart = 9, .area = 0.45}.pull();
    EXPECT_LT(overlapping, 1.3) << "3.0 if it were subtracted for all";
    EXPECT_GT(overlapping, 0.4);
    EXPECT_LT((TiltedLayer{.apart = 9, .area = 0.2}.pull()), 1.3);
    const double apart = TiltedLayer{.apart = 12, .area = 0.45}.pull();
    EXPECT_LT(apart, 1.3);
    EXPECT_GT(apart, 0.2) << "0.12 if it were subtracted for none";
}

TEST(SizeMisfit, LeavesErrorsLargeEnoughWhereFocusCurvesAlongTheTilt) {
    for (const double defocus : {1.0, 2.0}) {
        for (const double apart : {12.0, 9.0}) {
            EXPECT_LT((TiltedLayer{.apart = apart, .area = 0.45, .defocus = defocus}.pull()), 1.3)
                << "defocus " << defocus << ", apart " << apart;
        }
    }
}

}  // namespace
}  // namespace grainfield::tracking
