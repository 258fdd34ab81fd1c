#include "pipelines/render/rendered_frames.h"

#include <cstdint>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "pipelines/validate/stored_snapshots.h"

namespace grainfield::pipelines {
namespace {

/// One sphere that stands still and one that leaves the frame in the second of three snapshots.
StoredSnapshots two_spheres() {
    StoredSnapshots trajectory;
    TrajectoryInfo info;
    info.origin = Origin::md;
    info.time_unit = TimeUnit::sqrt_a_over_g;
    trajectory.set_info(info);
    for (int f = 0; f < 3; ++f) {
        Snapshot s;
        s.frame = f;
        s.time = 0.1 * f;
        s.box = {{0, 0}, {20, 20}, {}, 1.84};
        s.position = {{10.2, 9.9}, {f == 1 ? 19.0 : 11.5, 12.0}};
        s.id = {7, 8};
        s.z = {1.2, 0.6};
        s.velocity.resize(2);
        trajectory.write(s);
    }
    return trajectory;
}

simulate::RenderOptions small_view() {
    simulate::RenderOptions options;
    options.view.width = options.view.height = 120;
    options.view.scale = 12;
    return options;
}

TEST(RenderedFrames, CarryTheTruthOfEachFrameInAnyOrder) {
    StoredSnapshots trajectory = two_spheres();
    RunPlan plan;
    RenderedFrames frames(trajectory, trajectory.at(0).box, small_view(), 1, 2, plan);
    RenderedTruth truth(frames);
    EXPECT_EQ(frames.count(), 3);
    EXPECT_EQ(truth.info().length_unit, LengthUnit::pixel);
    const Snapshot last = truth.read(2);
    const Snapshot middle = truth.read(1);
    EXPECT_EQ(last.frame, 2);
    EXPECT_EQ(last.size(), 2U);
    ASSERT_EQ(middle.size(), 1U) << "the other one is out of sight";
    EXPECT_EQ(middle.id[0], 7);
    EXPECT_EQ(middle.layer[0], Layer::top);
    // The middle of the frame is the middle of the box; 700 a above, z shifts by 0.1 % of 0.2 a.
    EXPECT_NEAR(middle.position[0].x, 59.5 + 12 * 0.2, 0.01);
    EXPECT_NEAR(middle.position[0].y, 59.5 - 12 * 0.1, 0.01);
}

/// A grain that goes round in a periodic box, out of the frame on one side and in on the other.
StoredSnapshots going_round() {
    StoredSnapshots trajectory;
    TrajectoryInfo info;
    info.origin = Origin::md;
    info.time_unit = TimeUnit::sqrt_a_over_g;
    trajectory.set_info(info);
    for (int f = 0; f < 12; ++f) {
        Snapshot s;
        s.frame = f;
        s.time = f;
        s.box = {{0, 0}, {10, 10}, {Boundary::periodic, Boundary::periodic}, 1.84};
        s.position = {s.box.wrap({8.0 + 2.7 * f, 5}), {5, 5}};
        s.id = {0, 1};
        s.z = {1.2, 0.6};
        s.velocity.resize(2);
        trajectory.write(s);
    }
    return trajectory;
}

TEST(RenderedFrames, GiveTheSameIdentitiesInWhateverOrderTheyAreRead) {
    std::vector<std::vector<std::int64_t>> ids[2];
    for (const bool backwards : {false, true}) {
        StoredSnapshots trajectory = going_round();
        RunPlan plan;
        RenderedFrames frames(trajectory, trajectory.at(0).box, small_view(), 1, 1, plan);
        auto& seen = ids[backwards ? 1 : 0];
        seen.resize(12);
        // A tracker that cannot calibrate on the first frame looks at a later one first.
        if (backwards) static_cast<void>(frames.read(7));
        for (std::int64_t i = 0; i < 12; ++i) {
            const std::int64_t index = backwards ? 11 - i : i;
            seen[static_cast<std::size_t>(index)] = frames.truth(index).id;
        }
    }
    EXPECT_EQ(ids[0], ids[1]);
    EXPECT_EQ(ids[0][0], (std::vector<std::int64_t>{0, 1}));
    std::set<std::int64_t> first;
    for (const auto& frame : ids[0]) first.insert(frame[0]);
    EXPECT_EQ(first.size(), 4U) << "32 a in a box of 10 a: three crossings";
}

TEST(RenderedFrames, AreTheSameWhenReadAgain) {
    StoredSnapshots trajectory = two_spheres();
    RunPlan plan;
    RenderedFrames frames(trajectory, trajectory.at(0).box, small_view(), 1, 2, plan);
    const Image first = frames.read(0).image;
    EXPECT_EQ(frames.read(0).image, first);
    const Image second = frames.read(1).image;
    EXPECT_NE(second, first);
    EXPECT_EQ(frames.read(0).image, first);
}

TEST(RenderedFrames, KeepTheTruthOfLostFrames) {
    StoredSnapshots trajectory = two_spheres();
    simulate::RenderOptions options = small_view();
    options.exposure.drop_rate = 1;
    RunPlan plan;
    RenderedFrames frames(trajectory, trajectory.at(0).box, options, 1, 1, plan);
    EXPECT_EQ(frames.read(0).status, FrameStatus::missing);
    EXPECT_EQ(frames.truth(0).size(), 2U);
}

}  // namespace
}  // namespace grainfield::pipelines
