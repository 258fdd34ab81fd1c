#include "tracking/calibrate/model_fit.h"

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

const Image& frame() {
    static const Image frame =
        testing::tanh_frame(testing::hard_disc_liquid(300, 300, 16, 0.6, 1), 16, 1.2, 0.02, 2);
    return frame;
}

ModelFit fit_with(const CalibrationOptions& options) {
    return {.options = options,
            .detection = {},
            .refinement = {},
            .threads = 2,
            .levels = levels_of(frame())};
}

/// Discs a tenth too large, and soft.
ImageModel first_model() {
    ImageModel model;
    model.background = BackgroundSurface(200);
    model.dark_level = 40;
    model.disc = {17.6, 2};
    return model;
}

TEST(ModelFit, SettlesOnTheDiscsOfTheFrame) {
    ImageModel model = first_model();
    ModelFit fit = fit_with({});
    fit.settle(model, frame(), 4);
    EXPECT_NEAR(model.disc.diameter, 16, 0.1);
    EXPECT_NEAR(model.disc.edge_width, 1.2, 0.1);
    EXPECT_NEAR(model.dark_level, 30, 3);
    EXPECT_GT(fit.explained.signal, 0.95);
    // It is at rest: one more round brings no more than the tolerance.
    EXPECT_TRUE(fit.update(model, frame()));
}

TEST(ModelFit, KeepsLengthsThatAreGiven) {
    CalibrationOptions options;
    options.diameter = 15.5;
    options.edge_width = 1.5;
    ImageModel model = first_model();
    model.disc = {*options.diameter, *options.edge_width};
    ModelFit fit = fit_with(options);
    fit.settle(model, frame(), 2);
    EXPECT_EQ(model.disc.diameter, 15.5);
    EXPECT_EQ(model.disc.edge_width, 1.5);
    RunPlan plan;
    EXPECT_FALSE(fit.complete(model, frame(), plan)) << "nothing is left to be fitted";
    ASSERT_EQ(plan.skipped().size(), 1U);
    EXPECT_EQ(plan.skipped()[0].reason, "given");
}

TEST(ModelFit, OfBlocksTellsItsDiscInPixels) {
    ImageModel model;
    model.binning = {2};
    model.disc = model.binning.in_blocks(DiscProfile{16, 1.2});
    EXPECT_NEAR(disc_in_pixels(model).diameter, 16, 1e-12);
    EXPECT_NEAR(disc_in_pixels(model).edge_width, 1.2, 1e-12);
}

}  // namespace
}  // namespace grainfield::tracking
