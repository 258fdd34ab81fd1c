#include "tracking/calibrate/colour_mosaic.h"

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

Image layer() {
    const auto scene = testing::hard_disc_liquid(300, 300, 14, 0.5, 3);
    return testing::tanh_frame(scene, 14, 1.2, 0.03, 2);
}

/// The same seen through filters that pass these shares of the light.
Image behind(float a, float b, float c, float d) {
    Image image = layer();
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            image(x, y) *= y % 2 == 0 ? (x % 2 == 0 ? a : b) : (x % 2 == 0 ? c : d);
        }
    }
    return image;
}

TEST(ColourMosaic, FindsTheFilterOfAColourCamera) {
    // RGGB in white light, and in the light of a red lamp.
    EXPECT_TRUE(colour_mosaic(behind(0.7F, 1, 1, 0.8F), 30, 200).is_there);
    EXPECT_TRUE(colour_mosaic(behind(1, 0.4F, 0.4F, 0.3F), 30, 150).is_there);
    EXPECT_NEAR(colour_mosaic(behind(0.8F, 1, 1, 0.8F), 30, 200).strength, 0.2 / 0.9, 0.02);
}

TEST(ColourMosaic, IsNotSeenInGreyFrames) {
    EXPECT_FALSE(colour_mosaic(layer(), 30, 200).is_there);
    // Noise, and lines read by two amplifiers.
    EXPECT_FALSE(colour_mosaic(testing::noise_frame(300, 300, 120, 10, 0, 1), 90, 150).is_there);
    EXPECT_FALSE(colour_mosaic(behind(0.9F, 0.9F, 1, 1), 30, 200).is_there);
}

TEST(ColourMosaic, AnImageOfAFewPixelsSaysNothing) {
    EXPECT_FALSE(colour_mosaic(Image(1, 1), 0, 1).is_there);
    EXPECT_FALSE(colour_mosaic(Image(20, 20, 100.0F), 0, 100).is_there);
}

}  // namespace
}  // namespace grainfield::tracking
