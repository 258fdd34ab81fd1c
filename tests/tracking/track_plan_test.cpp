#include "tracking/track_plan.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

using ::testing::HasSubstr;

/// What the plan says of a stage, run or skipped; empty: nothing.
std::string said(const RunPlan& plan, const std::string& stage) {
    for (const PlannedStage& s : plan.stages()) {
        if (s.stage == stage) return s.reason;
    }
    return "";
}

RunPlan frames(const TrackOptions& options, std::int64_t count) {
    RunPlan plan;
    plan_frames({}, options, count, plan);
    return plan;
}

TEST(TrackPlan, LinksFilmsButNoPartsAndNoSingleFrames) {
    EXPECT_THAT(said(frames({}, 2), "link"), HasSubstr("least squared steps"));
    EXPECT_THAT(said(frames({}, 1), "link"), HasSubstr("one frame"));
    TrackOptions part;
    part.part = FrameSpan{0, 2};
    EXPECT_THAT(said(frames(part, 2), "link"), HasSubstr("grainfield link"));
    EXPECT_NE(said(frames({}, 2), "warm start"), "");
    EXPECT_EQ(said(frames({}, 1), "warm start"), "");
}

TEST(TrackPlan, SaysWhereLayersComeFrom) {
    const auto layers = [](const TrackOptions& options) {
        RunPlan plan;
        plan_heights(options, plan);
        return said(plan, "layers");
    };
    TrackOptions options;
    EXPECT_THAT(layers(options), HasSubstr("layers.height"));
    options.layers.height = 1.94;
    EXPECT_THAT(layers(options), HasSubstr("overlaps in projection"));
    options.synthesis = true;
    EXPECT_THAT(layers(options), HasSubstr("synthesis has a sphere"));
}

TEST(TrackPlan, SaysWhatACameraLeavesOfTheFrame) {
    Camera camera;
    camera.width = 100;
    camera.height = 50;
    Box box;
    box.length = {50, 50};
    RunPlan plan;
    plan_camera(CameraMap(camera, Vec2{0, 0}), box, 100, 50, plan);
    EXPECT_THAT(said(plan, "camera"), HasSubstr("50.0 x 50.0 px, 50.0 % of the frame"));
}

}  // namespace
}  // namespace grainfield::tracking
