#include "tracking/track_options.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/memory_frames.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {
namespace {

using ::testing::HasSubstr;

/// What is said where these options are refused; empty: they are not.
std::string refusal(const TrackOptions& options) {
    try {
        require_consistent(options);
    } catch (const OptionError& error) {
        return error.what();
    }
    return "";
}

TrackOptions mirrors(bool synthesis, bool correct_bias) {
    TrackOptions options;
    options.sphere_diameter = 12;
    options.synthesis = synthesis;
    options.correct_bias = correct_bias;
    return options;
}

Camera straight_camera() {
    Camera camera;
    camera.width = 64;
    camera.height = 64;
    return camera;
}

TEST(TrackOptions, OfTheDefaultAreConsistent) {
    EXPECT_EQ(refusal({}), "");
    EXPECT_EQ(refusal(mirrors(true, false)), "");
    EXPECT_EQ(refusal(mirrors(false, true)), "");
}

TEST(TrackOptions, HeightsSynthesisAndBiasNeedTheTrueDiameter) {
    TrackOptions height;
    height.layers.height = 1.94;
    EXPECT_THAT(refusal(height), HasSubstr("the height of the cell needs the true diameter"));
    height.sphere_diameter = 12;
    EXPECT_EQ(refusal(height), "");
    for (const bool synthesis : {true, false}) {
        TrackOptions options = mirrors(synthesis, !synthesis);
        options.sphere_diameter.reset();
        EXPECT_THAT(refusal(options), HasSubstr("track.sphere-diameter is not known"));
    }
}

TEST(TrackOptions, SynthesisAndBiasExcludeEachOther) {
    EXPECT_THAT(refusal(mirrors(true, true)), HasSubstr("synthesis is asked for, too"));
}

TEST(TrackOptions, SynthesisAndBiasNeedWholeFramesThroughAStraightLens) {
    for (const bool synthesis : {true, false}) {
        TrackOptions masked = mirrors(synthesis, !synthesis);
        Image mask(64, 64, 1.0F);
        mask(3, 3) = 0;
        masked.visible = VisiblePixels(mask);
        EXPECT_THAT(refusal(masked), HasSubstr("mask"));
        TrackOptions tilted = mirrors(synthesis, !synthesis);
        tilted.camera.emplace(straight_camera(), Vec2{0, 0});
        EXPECT_THAT(refusal(tilted), HasSubstr("a camera is given"));
    }
}

TEST(TrackOptions, AKeptCorrectionGoesWithAndWithoutTheTrueDiameter) {
    TrackOptions options;
    options.kept.emplace().bias.emplace();
    EXPECT_EQ(refusal(options), "");
    options.sphere_diameter = 12;
    EXPECT_EQ(refusal(options), "");
}

TEST(TrackOptions, AKeptCalibrationGoesWithNoneThatEstimates) {
    TrackOptions options;
    options.kept.emplace();
    options.calibration.diameter = 9;
    EXPECT_THAT(refusal(options), HasSubstr("a kept calibration leaves nothing to estimate"));
}

TEST(TrackOptions, KnownSizesSayWhichSpheresHaveRoom) {
    TrackOptions options;
    EXPECT_FALSE(detection_of(options).sphere_diameter.has_value());
    options.sphere_diameter = 12;
    options.layers.height = 1.7;
    options.detection.border = 0.4;
    const DetectionOptions detection = detection_of(options);
    EXPECT_EQ(detection.sphere_diameter, 12);
    EXPECT_EQ(detection.cell_height, 1.7);
    EXPECT_EQ(detection.border, 0.4);
}

TEST(TrackOptions, OfADiameterThatDiscsDoNotSuitAreWarnedOf) {
    TrackOptions options;
    const auto warnings = [&](double apparent) {
        RunPlan plan;
        warn_of_unusual_size(apparent, options, plan);
        return plan.warnings().size();
    };
    EXPECT_EQ(warnings(5), 0U) << "none is given";
    options.sphere_diameter = 10;
    EXPECT_EQ(warnings(8.8), 0U);
    EXPECT_EQ(warnings(7.07), 0U);
    EXPECT_EQ(warnings(10.2), 0U);
    EXPECT_EQ(warnings(5), 1U);
    EXPECT_EQ(warnings(11.5), 1U);
    RunPlan plan;
    warn_of_unusual_size(5, options, plan);
    EXPECT_THAT(plan.warnings().front().text,
                HasSubstr("5.0 px wide, 0.50 of the 10 px of track.sphere-diameter"));
}

TEST(TrackOptions, ThatContradictEachOtherAreRefusedBeforeAnyFrameIsRead) {
    MemoryFrames frames({Image(64, 64, 1.0F)});
    RunPlan plan;
    EXPECT_THROW(Tracker(frames, mirrors(true, true), plan), OptionError);
}

}  // namespace
}  // namespace grainfield::tracking
