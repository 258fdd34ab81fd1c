#include "tracking/calibrate/model_choice.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/model/blurred_union.h"

namespace grainfield::tracking {
namespace {

using testing::LayerScene;

constexpr int kSize = 200;
constexpr DiscProfile kDisc{16, 1.2};

/// The model that the frames are made with.
ImageModel true_model() {
    ImageModel model;
    model.disc = kDisc;
    model.background = BackgroundSurface(200);
    model.dark_level = 30;
    return model;
}

struct Choice {
    ImageModel model = true_model();
    RunPlan plan;
};

Choice chosen(const Image& frame, const LayerScene& scene, const CalibrationOptions& options) {
    Choice choice;
    choose_model(frame, scene.position, options, {}, {.tolerance = 0.02, .max_sweeps = 30}, 2, {},
                 choice.model, choice.plan);
    return choice;
}

const PlannedStage& stage(const RunPlan& plan, const std::string& name) {
    for (const PlannedStage& s : plan.stages()) {
        if (s.stage == name) return s;
    }
    throw std::out_of_range(name);
}

/// Area coverage of the union of sharp discs, blurred: a lens before opaque spheres.
Image lens_frame(const LayerScene& scene) {
    testing::Camera camera;
    camera.apparent_diameter = 1;
    camera.rim_darkness = 1;
    camera.vignetting = 0;
    return testing::camera_frame(scene, camera, 1);
}

TEST(ModelChoice, WhereTransmissionsMultiplyTheProductIsChosen) {
    const auto scene = testing::crystal_in_liquid(kSize, kSize, 16, 0.6, {.radius = 0.3}, 3);
    const Choice c = chosen(testing::tanh_frame(scene, 16, 1.2, 0.02, 1), scene, {});
    EXPECT_EQ(c.model.overlap->name(), "product");
    EXPECT_TRUE(stage(c.plan, "meeting edges").runs);
    EXPECT_FALSE(stage(c.plan, "profile").runs) << "tanh unless asked for";
}

TEST(ModelChoice, WhereALensBlursOpaqueDiscsTheUnionIsChosen) {
    const auto scene = testing::crystal_in_liquid(kSize, kSize, 16, 0.6, {.radius = 0.3}, 3);
    const Image frame = lens_frame(scene);
    RunPlan plan;
    const auto calibration = calibrate(frame, {}, {}, {}, 2, plan);
    ASSERT_TRUE(calibration);
    EXPECT_EQ(calibration->model.overlap->name(), "blurred-union");
}

TEST(ModelChoice, WhatIsGivenIsTakenWithoutAFit) {
    const auto scene = testing::hard_disc_liquid(kSize, kSize, 16, 0.6, 1);
    const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 1);
    CalibrationOptions options;
    options.meeting_edges = &kBlurredUnion;
    const Choice c = chosen(frame, scene, options);
    EXPECT_EQ(c.model.overlap->name(), "blurred-union");
    EXPECT_FALSE(stage(c.plan, "meeting edges").runs);
}

TEST(ModelChoice, ALearnedProfileThatWasAskedForNeedsPixelsToLearnFrom) {
    LayerScene few = testing::isolated_discs(kSize, kSize, 16, 300, 1);
    few.position = {{100, 100}};
    const Image frame = testing::tanh_frame(few, 16, 1.2, 0.02, 1);
    CalibrationOptions options;
    options.profile.learning = Learning::always;
    const Choice c = chosen(frame, few, options);
    EXPECT_TRUE(c.model.correction.is_zero());
    ASSERT_EQ(c.plan.warnings().size(), 1U);
    EXPECT_NE(c.plan.warnings()[0].text.find("no profile was learned"), std::string::npos);
}

TEST(ModelChoice, OfExactTanhEdgesNoOtherProfileIsChosen) {
    const auto scene = testing::hard_disc_liquid(kSize, kSize, 16, 0.5, 1);
    const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 1);
    CalibrationOptions options;
    options.profile.learning = Learning::automatic;
    const Choice c = chosen(frame, scene, options);
    EXPECT_TRUE(c.model.correction.is_zero());
    EXPECT_FALSE(stage(c.plan, "profile").runs);
}

}  // namespace
}  // namespace grainfield::tracking
