#include "tracking/tracking.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/memory_frames.h"
#include "tests/support/collect.h"
#include "tests/support/layer_frames.h"
#include "tests/support/position_score.h"

namespace grainfield::tracking {
namespace {

using testing::LayerScene;

constexpr int kSize = 200;
constexpr double kDiameter = 16;

Image frame_of(const LayerScene& scene, std::uint64_t seed) {
    return testing::tanh_frame(scene, kDiameter, 1.2, 0.02, seed);
}

std::vector<Image> film(std::vector<LayerScene>& truth) {
    std::vector<Image> images;
    testing::LayerMotion motion(testing::hard_disc_liquid(kSize, kSize, kDiameter, 0.5, 1), {},
                                0.05 * kDiameter, 1);
    for (std::uint64_t f = 0; f < 4; ++f) {
        truth.push_back(motion.scene());
        images.push_back(frame_of(motion.scene(), f));
        motion.advance();
    }
    return images;
}

TEST(Tracking, LocateFindsEverySphereOfAnImage) {
    const auto scene = testing::hard_disc_liquid(kSize, kSize, kDiameter, 0.5, 1);
    RunPlan plan;
    const Snapshot found = locate(frame_of(scene, 1), {.threads = 2}, &plan);
    require_consistent(found);
    const auto score =
        testing::score_positions(found.position, scene.position, 4, kSize, kSize, kDiameter);
    EXPECT_EQ(score.missed, 0);
    EXPECT_EQ(score.spurious, 0);
    // Bound 0.0084 px (case A of docs/validation.md); 60 spheres scatter by 6.5 %, four times that.
    EXPECT_LT(score.rms, 1.26 * 0.0084);
    EXPECT_EQ(found.position_error.size(), found.size());
    EXPECT_EQ(found.box.length.x, kSize);
    EXPECT_FALSE(plan.stages().empty());
    // Without a plan, and on one thread, the same.
    EXPECT_EQ(locate(frame_of(scene, 1), {.threads = 1}).position, found.position);
}

TEST(Tracking, LocateUsesWhatIsGiven) {
    const auto scene = testing::hard_disc_liquid(kSize, kSize, kDiameter, 0.5, 1);
    LocateOptions options{.threads = 2};
    options.detection.border = 2;
    const Snapshot inner = locate(frame_of(scene, 1), options);
    ASSERT_GT(inner.size(), 0U);
    for (const Vec2 p : inner.position) EXPECT_GE(std::min(p.x, p.y), 1.9 * kDiameter);
}

TEST(Tracking, LocateOfNothingIsEmptyAndSaysWhy) {
    RunPlan plan;
    EXPECT_EQ(locate(Image(64, 64, 7.0F), {.threads = 1}, &plan).size(), 0U);
    EXPECT_FALSE(plan.warnings().empty());
    EXPECT_THROW(locate(Image()), InputError);
}

TEST(Tracking, TrackKeepsTheTrajectoryThatASinkWouldGet) {
    std::vector<LayerScene> truth;
    const std::vector<Image> images = film(truth);
    MemoryFrames frames(images, 100.0);
    TrackOptions options;
    options.threads = 2;
    const Trajectory trajectory = track(frames, options);
    ASSERT_EQ(trajectory.snapshots.size(), images.size());
    EXPECT_EQ(trajectory.info.origin, Origin::video);
    EXPECT_EQ(trajectory.info.frame_rate, 100.0);
    EXPECT_NEAR(trajectory.info.diameter, kDiameter, 0.1);
    testing::Collect sink;
    const TrackSummary summary = track(frames, sink, options);
    EXPECT_EQ(summary.frames, 4);
    for (std::size_t f = 0; f < images.size(); ++f) {
        EXPECT_EQ(trajectory.snapshots[f].position, sink.snapshots[f].position);
        EXPECT_EQ(trajectory.snapshots[f].id, sink.snapshots[f].id);
        const auto score = testing::score_positions(trajectory.snapshots[f].position,
                                                    truth[f].position, 4, kSize, kSize, kDiameter);
        EXPECT_EQ(score.missed + score.spurious, 0);
    }
    EXPECT_DOUBLE_EQ(trajectory.snapshots[3].time, 0.03);
}

}  // namespace
}  // namespace grainfield::tracking
