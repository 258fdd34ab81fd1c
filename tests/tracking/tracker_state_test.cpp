#include "tracking/tracker_state.h"

#include <tuple>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::tracking {
namespace {

template <class T>
std::vector<double> saved(T value) {
    NumberArchive archive;
    transfer(archive, value);
    return archive.take_numbers();
}

template <class T>
T restored(const std::vector<double>& numbers) {
    NumberArchive archive(numbers);
    T value;
    transfer(archive, value);
    archive.require_end();
    return value;
}

// The names do not compile unless they are all members that there are.
TEST(TrackerCheckpoint, EveryMemberOfWhatWasLocatedSurvives) {
    Located before;
    {
        auto& [position, error, residual, edge_residual, explained, residual_rms, correlation,
               noise, passes, added, removed, coarse_steps, steps, warm, approached, maps_skipped,
               maps_in_part, trials, trials_kept, mended, joint_steps, arrangements,
               arrangements_taken, evidence, doubtful_are_false, fitted, unsettled, rejected,
               settled_detection, detect_seconds, refine_seconds] = before;
        position = {{1, 2}};
        error = {{3, 4}};
        residual = {5};
        edge_residual = {25};
        explained = {6, 7};
        std::tie(residual_rms, noise, evidence, detect_seconds, refine_seconds) =
            std::tuple{0.1, 0.2, 0.3, 0.4, 0.5};
        correlation = 24;
        std::tie(passes, maps_skipped, maps_in_part) = std::tuple{8, 9, 10};
        std::tie(arrangements, arrangements_taken) = std::tuple{22, 23};
        std::tie(trials_kept, joint_steps, mended) = std::tuple{26, 27, 28};
        std::tie(added, removed, coarse_steps, steps, trials, unsettled, rejected) =
            std::tuple{11, 12, 13, 14, 15, 16, 17};
        std::tie(warm, approached, doubtful_are_false, settled_detection) =
            std::tuple{true, true, true, false};
        fitted = {{18, 19}, {20, 21}};
    }
    const std::vector<double> numbers = saved(before);
    const Located after = restored<Located>(numbers);
    EXPECT_EQ(saved(after), numbers);
    EXPECT_EQ(after.trials, 15);
    EXPECT_EQ(after.trials_kept, 26);
    EXPECT_EQ(after.joint_steps, 27);
    EXPECT_EQ(after.mended, 28);
    EXPECT_EQ(after.arrangements_taken, 23);
    EXPECT_EQ(after.evidence, 0.3);
    EXPECT_TRUE(after.doubtful_are_false);
    EXPECT_EQ(after.correlation, 24);
    EXPECT_EQ(after.edge_residual, before.edge_residual);
    EXPECT_EQ(after.fitted, before.fitted);
    EXPECT_FALSE(after.settled_detection);
    EXPECT_EQ(after.refine_seconds, 0.5);
}

TEST(TrackerCheckpoint, EveryMemberOfTheSummarySurvives) {
    TrackSummary before;
    before.frames = 1;
    before.particles_mean = 2.5;
    before.step_rms = 3.5;
    before.layers.labelled = 4;
    before.layers.is_exact = false;
    before.synthesis.doubtful = 7;
    before.synthesis.optics.grazing = 8.5;
    before.ms_per_frame.synthesis = 9.5;
    before.ms_per_frame.wall = 5.5;
    before.brightest = 6.5;
    before.work_per_frame.trials_kept = 10.5;
    const TrackSummary after = restored<TrackSummary>(saved(before));
    EXPECT_EQ(after.frames, 1);
    EXPECT_EQ(after.particles_mean, 2.5);
    EXPECT_EQ(after.step_rms, 3.5);
    EXPECT_EQ(after.layers.labelled, 4);
    EXPECT_FALSE(after.layers.is_exact);
    EXPECT_EQ(after.synthesis.doubtful, 7);
    EXPECT_EQ(after.synthesis.optics.grazing, 8.5);
    EXPECT_EQ(after.ms_per_frame.synthesis, 9.5);
    EXPECT_EQ(after.ms_per_frame.wall, 5.5);
    EXPECT_EQ(after.brightest, 6.5);
    EXPECT_EQ(after.work_per_frame.trials_kept, 10.5);
}

TEST(TrackerCheckpoint, WhatSynthesisFoundSurvives) {
    SynthesisedFrame before;
    before.position = {{1, 2}, {3, 4}};
    before.error = {{0.1, 0.2}, {0.3, 0.4}};
    before.z = {0.5, 0.6};
    before.z_error = {0.7, 0.8};
    before.residual = {0.9, 1.1};
    before.optics = {.reflectivity = 0.51,
                     .blur = 0.06,
                     .ambient = 0.03,
                     .grazing = 0.3,
                     .distance = 70,
                     .middle_x = 5,
                     .middle_y = 6,
                     .reflections = 3};
    before.residual_before = 0.04;
    before.residual_rms = 0.02;
    before.added = 7;
    const std::vector<double> numbers = saved(before);
    const SynthesisedFrame after = restored<SynthesisedFrame>(numbers);
    EXPECT_EQ(saved(after), numbers);
    EXPECT_EQ(after.z, before.z);
    EXPECT_EQ(after.optics.reflections, 3);
    EXPECT_EQ(after.added, 7);
}

TEST(TrackerCheckpoint, TheStateOfTheLinkerSurvives) {
    LinkState before;
    before.tracks = {{1, 2, {3, 4}, {5, 6}, Vec2{7, 8}}, {9, 10, {11, 12}, {13, 14}, {}}};
    before.next_id = 15;
    before.frame = 16;
    before.drift = {17, 18};
    before.motion = 19;
    before.summary.range = 20;
    before.summary.subnets.reduced = 21;
    const std::vector<double> numbers = saved(before);
    const LinkState after = restored<LinkState>(numbers);
    EXPECT_EQ(saved(after), numbers);
    ASSERT_EQ(after.tracks.size(), 2U);
    EXPECT_EQ(after.tracks[0].velocity, (Vec2{7, 8}));
    EXPECT_FALSE(after.tracks[1].velocity);
    EXPECT_EQ(after.summary.subnets.reduced, 21);
}

TEST(TrackerCheckpoint, NumbersThatAreMissingAreRefused) {
    std::vector<double> numbers = saved(Located{});
    numbers.pop_back();
    EXPECT_THROW(restored<Located>(numbers), InputError);
}

}  // namespace
}  // namespace grainfield::tracking
