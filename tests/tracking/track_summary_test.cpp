#include "tracking/track_summary.h"

#include <string>

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

Located found_with(double residual, double noise) {
    Located found;
    found.position = {{1, 1}};
    found.residual_rms = residual;
    found.noise = noise;
    found.settled_detection = true;
    return found;
}

Frame frame_number(std::int64_t index) {
    Frame frame;
    frame.index = index;
    return frame;
}

bool says(const RunPlan& plan, const std::string& words) {
    for (const Warning& warning : plan.warnings()) {
        if (warning.text.find(words) != std::string::npos) return true;
    }
    return false;
}

TEST(TrackSummary, CountsFramesThatAreBadlyExplainedAndNamesTheWorst) {
    TrackSummary summary;
    RepeatedWarnings repeated;
    RunPlan plan;
    judge(found_with(0.05, 0.01), frame_number(3), summary, repeated, plan);
    judge(found_with(0.19, 0.10), frame_number(4), summary, repeated, plan);  // twice the noise
    EXPECT_EQ(summary.poor_frames, 0);
    judge(found_with(0.13, 0.01), frame_number(5), summary, repeated, plan);
    judge(found_with(0.26, 0.30), frame_number(6), summary, repeated, plan);
    judge(found_with(0.14, 0.01), frame_number(7), summary, repeated, plan);
    EXPECT_EQ(summary.poor_frames, 3);
    EXPECT_EQ(summary.worst_frame, 6);
    EXPECT_EQ(summary.worst_residual, 0.26);
    summary.frames = 5;
    warn_of(summary, plan);
    EXPECT_TRUE(says(plan, "explains 3 of 5 frames badly, worst frame 6"));
}

TEST(TrackSummary, GivesMeansOverFrames) {
    TrackSummary summary;
    summary.frames = 4;
    summary.residual_rms = 0.2;
    summary.noise = 0.12;
    summary.ms_per_frame.refine = 60;
    LinkSummary links;
    links.consecutive = 8;
    links.squared_steps = 32;
    average(summary, 100, links);
    EXPECT_DOUBLE_EQ(summary.residual_rms, 0.05);
    EXPECT_DOUBLE_EQ(summary.noise, 0.03);
    EXPECT_DOUBLE_EQ(summary.ms_per_frame.refine, 15);
    EXPECT_DOUBLE_EQ(summary.particles_mean, 25);
    EXPECT_DOUBLE_EQ(summary.step_rms, 2);
}

TEST(TrackSummary, SaysWhatTheFittedFramesTook) {
    Located found;
    found.steps = 70;
    found.coarse_steps = 30;
    found.joint_steps = 3;
    found.passes = 5;
    found.maps_skipped = 1;
    found.trials = 8;
    found.trials_kept = 2;
    TrackSummary summary;
    summary.frames = 5;  // three of them repeat another or are blank
    found.fitted.resize(30);
    add(found, summary.work_per_frame);
    add({}, summary.work_per_frame);
    average(summary, 100, {});
    EXPECT_EQ(summary.work_per_frame.frames, 2);
    EXPECT_EQ(summary.work_per_frame.discs, 15);
    EXPECT_EQ(summary.work_per_frame.disc_updates, 50);
    EXPECT_EQ(summary.work_per_frame.joint_steps, 1.5);
    EXPECT_EQ(summary.work_per_frame.gain_maps, 2);
    EXPECT_EQ(summary.work_per_frame.trials, 4);
    EXPECT_EQ(summary.work_per_frame.trials_kept, 1);
}

TEST(TrackSummary, OfNoFramesIsFinite) {
    TrackSummary summary;
    average(summary, 0, {});
    EXPECT_EQ(summary.particles_mean, 0);
    EXPECT_EQ(summary.step_rms, 0);
}

TEST(TrackSummary, CountsContradictionsBesideAllThatHaveNoLayer) {
    TrackSummary summary;
    summary.layers = {.spheres = 100, .labelled = 40, .top = 18, .contradictory = 3};
    RunPlan plan;
    warn_of(summary, plan);
    EXPECT_TRUE(says(plan, "overlaps of 3 positions contradict"));
    EXPECT_TRUE(says(plan, "Of all, 60 of 100 are unknown"));
}

TEST(TrackSummary, WarnsOfLightThatVariesByMoreThanATwentieth) {
    TrackSummary summary;
    summary.dimmest = 0.96;
    RunPlan quiet;
    warn_of(summary, quiet);
    EXPECT_TRUE(quiet.warnings().empty());
    summary.brightest = 1.06;
    RunPlan plan;
    warn_of(summary, plan);
    EXPECT_TRUE(says(plan, "between 0.96 and 1.06"));
}

}  // namespace
}  // namespace grainfield::tracking
