#include "tracking/calibrate/calibration_view.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

ModelFit fit_of(const Image& counts, const CalibrationOptions& options, VisiblePixels visible) {
    return {.options = options,
            .detection = {},
            .refinement = {},
            .threads = 2,
            .levels = levels_of(counts, visible),
            .visible = visible};
}

Image liquid() {
    return testing::tanh_frame(testing::hard_disc_liquid(101, 91, 16, 0.6, 2), 16, 1.2, 0.02, 1);
}

TEST(CalibrationView, OfPixelsIsTheFrameItself) {
    const Image counts = liquid();
    CalibrationOptions options;
    options.diameter = 16;
    options.edge_width = 1.2;
    const CalibrationView view = view_by({}, counts, fit_of(counts, options, {}));
    EXPECT_TRUE(std::ranges::equal(view.counts.pixels(), counts.pixels()));
    EXPECT_EQ(view.fit.options, options);
    EXPECT_TRUE(view.fit.blocks.is_none());
}

TEST(CalibrationView, OfBlocksHasItsLengthsInBlocks) {
    const Image counts = liquid();
    Image mask(counts.width(), counts.height(), 1);
    mask(7, 5) = 0;
    CalibrationOptions options;
    options.diameter = 16;
    options.edge_width = 1.2;
    const CalibrationView view = view_by({2}, counts, fit_of(counts, options, VisiblePixels(mask)));
    EXPECT_EQ(view.counts.width(), 50);
    EXPECT_EQ(view.counts.height(), 45);
    EXPECT_FLOAT_EQ(view.counts(3, 2),
                    (counts(6, 4) + counts(7, 4) + counts(6, 5) + counts(7, 5)) / 4);
    EXPECT_EQ(view.fit.options.diameter, 8);
    // The mean over a block adds 2²/12 to the variance π²w²/12 of the edge.
    EXPECT_DOUBLE_EQ(*view.fit.options.edge_width, std::hypot(1.2, 2 / std::numbers::pi) / 2);
    EXPECT_FALSE(view.fit.visible(3, 2));
    EXPECT_TRUE(view.fit.visible(2, 2));
    EXPECT_EQ(view.fit.blocks.factor, 2);
    EXPECT_EQ(view.fit.levels.noise, levels_of(view.counts, view.fit.visible).noise);
}

TEST(CalibrationView, BlocksAreEnoughWhereSharpDiscsLeaveMoreThanTwiceTheNoise) {
    ImageModel model;
    model.binning = {2};
    model.disc = model.binning.in_blocks(DiscProfile{16, 1.2});
    model.noise = 0.01;
    const BinningUse use{.factor = 2, .widest_edge = 1.5};
    model.residual_rms = 0.01 * std::hypot(1, 2.1);
    EXPECT_TRUE(blocks_are_enough(use, model));
    model.residual_rms = 0.01 * std::hypot(1, 1.9);
    EXPECT_FALSE(blocks_are_enough(use, model));
    EXPECT_TRUE(blocks_are_enough({.factor = 2}, model)) << "as given";
    model.residual_rms = 0.1;
    model.disc = model.binning.in_blocks(DiscProfile{16, 1.6});
    EXPECT_FALSE(blocks_are_enough(use, model));
}

}  // namespace
}  // namespace grainfield::tracking
