#include "tracking/model/binning.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tracking/model/image_model.h"
#include "tracking/model/padded_image.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

TEST(Binning, IsTheMeanOfEachBlockAndLeavesTheRestOut) {
    Image frame(8, 5);
    for (int y = 0; y < 5; ++y) {
        for (int x = 0; x < 8; ++x) frame(x, y) = static_cast<float>(10 * y + x);
    }
    const Image binned = Binning{3}.binned(frame);
    ASSERT_EQ(binned.width(), 2);
    ASSERT_EQ(binned.height(), 1);
    EXPECT_FLOAT_EQ(binned(0, 0), 11);
    EXPECT_FLOAT_EQ(binned(1, 0), 14);
}

TEST(Binning, PutsTheCentreOfABlockInTheMiddleOfItsPixels) {
    const Binning blocks{2};
    EXPECT_EQ(blocks.in_frame(Vec2{3, 0}), (Vec2{6.5, 0.5}));
    const Vec2 place{17.25, 4.75};
    EXPECT_EQ(blocks.in_frame(blocks.in_blocks(place)), place);
    EXPECT_EQ(Binning{}.in_frame(place), place);
}

TEST(Binning, OfADiscIsADiscOfTheSmallerSize) {
    const DiscProfile disc{14.2, 1.6};
    PaddedImage transmission = clear_transmission(80, 80, disc);
    const Vec2 place{38.3, 41.7};
    place_discs(transmission, {place}, disc);
    const Binning blocks{2};
    const Image seen = blocks.binned(transmission.inner());
    const DiscProfile small = blocks.in_blocks(disc);
    PaddedImage expected = clear_transmission(40, 40, small);
    place_discs(expected, {blocks.in_blocks(place)}, small);
    double worst = 0;
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 40; ++x) {
            worst = std::max(worst, std::abs(static_cast<double>(seen(x, y)) -
                                             static_cast<double>(expected.row(y)[x])));
        }
    }
    // A block is no tanh: 0.008 of the contrast. With the width of the frame it were 0.04.
    EXPECT_LT(worst, 0.012);
}

TEST(Binning, TakesAnEdgeBackToThatOfTheFrame) {
    for (const int factor : {1, 2, 3}) {
        const Binning blocks{factor};
        const DiscProfile disc{14.2, 1.6};
        const DiscProfile back = blocks.in_frame(blocks.in_blocks(disc));
        EXPECT_NEAR(back.diameter, disc.diameter, 1e-12) << factor;
        EXPECT_NEAR(back.edge_width, disc.edge_width, 1e-12) << factor;
    }
    EXPECT_GT((Binning{4}.in_frame(DiscProfile{7, 0.1}).edge_width), 0)
        << "sharper than any block shows";
}

TEST(Binning, OfAnImageModelIsTakenBackToPixels) {
    const Binning blocks{2};
    ImageModel binned;
    binned.binning = blocks;
    binned.disc = blocks.in_blocks(DiscProfile{14, 1.5});
    binned.background = BackgroundSurface(40, 30, 1, {200, 8, -13});
    binned.dark_level = 20;
    binned.noise = 0.01;
    binned.residual_rms = std::hypot(0.01, 0.05);
    binned.correction = {.spacing = 0.25, .value = {0.1F, 0.2F, 0.0F}};
    const ImageModel model = binned.in_pixels();
    EXPECT_TRUE(model.binning.is_none());
    EXPECT_NEAR(model.background(22.5, 14.5), binned.background(11, 7), 1e-12);
    EXPECT_NEAR(model.disc.edge_width, 1.5, 1e-12);
    EXPECT_DOUBLE_EQ(model.noise, 0.02);
    EXPECT_NEAR(model.residual_rms, std::hypot(0.02, 0.05), 1e-12) << "misfit stays, noise grows";
    EXPECT_DOUBLE_EQ(model.correction.spacing, 0.5);
}

}  // namespace
}  // namespace grainfield::tracking
