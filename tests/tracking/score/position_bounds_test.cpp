#include "tracking/score/position_bounds.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/locate.h"
#include "tracking/score/detection_scores.h"

namespace grainfield::tracking {
namespace {

TEST(PositionBounds, OfAnIsolatedDiscIsTheClosedForm) {
    // σ_x = σ sqrt(6w/πD): .00757 px at 2 % noise, 16 px, 1.2 px (docs/tracking.md).
    const auto bounds = position_bounds({{40.3, 40.8}}, {16, 1.2}, 80, 80, 0.02, 1);
    const double expected = 0.02 * std::sqrt(6 * 1.2 / (std::numbers::pi * 16));
    EXPECT_NEAR(bounds[0].x, expected, 0.01 * expected);
    EXPECT_NEAR(bounds[0].y, expected, 0.01 * expected);
}

TEST(PositionBounds, DiscsOutsideTheFrameHaveNoneAndDoNotDisturb) {
    const DiscProfile disc{16, 1.2};
    const auto alone = position_bounds({{40, 40}}, disc, 80, 80, 0.02, 1);
    const auto bounds =
        position_bounds({{-200, 40}, {40, 40}, {1e9, 3}, {0, 70}}, disc, 80, 80, 0.02, 1);
    EXPECT_TRUE(std::isnan(bounds[0].x));
    EXPECT_TRUE(std::isnan(bounds[2].y));
    EXPECT_EQ(bounds[1], alone[0]);
    EXPECT_GT(bounds[3].x, 1.2 * alone[0].x) << "half a disc says less";
}

TEST(PositionBounds, AreReachedByTheTrackerOnItsOwnImageModel) {
    const auto scene = testing::hard_disc_liquid(640, 640, 16, 0.70, 1);
    const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 1);
    RunPlan plan;
    const auto calibration = calibrate(frame, {}, {}, {}, 2, plan);
    ASSERT_TRUE(calibration);
    Locator locator(640, 640, calibration->model.disc, 2);
    const auto found = locator.locate(calibration->model.darkness(frame), {}, {});
    DetectionScores scores({"all"}, 4);
    TruthFrame truth{scene.position, {}, {}};
    truth.bound = position_bounds(scene.position, {16, 1.2}, 640, 640, 0.02, 2);
    for (const Vec2 p : scene.position) {
        truth.classes.push_back(std::min({p.x, p.y, 639 - p.x, 639 - p.y}) >= 16 ? 1 : 0);
    }
    std::vector<Vec2> errors = found.error;
    for (Vec2& e : errors) e *= found.noise;
    scores.add(truth, found.position, errors);
    const ClassScore& all = scores.find("all");
    EXPECT_EQ(all.missed, 0);
    EXPECT_EQ(all.spurious, 0);
    // The joint bound of this case is .00835 px (JointInformation of one such frame).
    EXPECT_NEAR(all.bound(), 0.00835, 0.0003);
    // 2,400 errors scatter by 1.4 %, 8-bit rounding adds 1 %.
    EXPECT_GT(all.bound_ratio(), 0.93);
    EXPECT_LT(all.bound_ratio(), 1.10);
    EXPECT_NEAR(all.pull_rms(), 1, 0.1);
}

}  // namespace
}  // namespace grainfield::tracking
