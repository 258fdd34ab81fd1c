#include "tracking/score/edge_noise.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

ImageModel model_of(const DiscProfile& disc, double background, double dark) {
    ImageModel model;
    model.disc = disc;
    model.background = BackgroundSurface(background);
    model.dark_level = dark;
    return model;
}

TEST(EdgeNoise, IsThatOfTheFrameWhereItIsTheSameEverywhere) {
    const auto scene = testing::isolated_discs(640, 640, 20, 40, 1);
    const Image frame = testing::tanh_frame(scene, 20, 1.2, 0.02, 1);
    // 3.4 counts of noise and 1/√12 of rounding on a contrast of 170; 2e5 differences.
    const double expected = std::hypot(3.4, std::sqrt(1.0 / 12)) / 170;
    EXPECT_NEAR(edge_noise(frame, model_of({20, 1.2}, 200, 30), scene.position), expected,
                0.02 * expected);
}

TEST(EdgeNoise, IsTheMeanVarianceOfLightAndShade) {
    const auto scene = testing::isolated_discs(640, 640, 20, 40, 1);
    Image frame = testing::tanh_frame(scene, 20, 1.2, 0, 1);
    RandomStream random(3, "noise");
    for (float& p : frame.pixels()) {
        const double darkness = (200 - static_cast<double>(p)) / 170;
        p += static_cast<float>((4 - 3 * darkness) * random.normal());
    }
    frame(100, 100) = 4000;  // a hot pixel
    const double expected = std::sqrt((16 + 1 + 2 / 12.0) / 2) / 170;
    EXPECT_NEAR(edge_noise(frame, model_of({20, 1.2}, 200, 30), scene.position), expected,
                0.02 * expected);
}

TEST(EdgeNoise, OfASaturatedBackgroundIsThatOfTheCores) {
    const auto scene = testing::isolated_discs(640, 640, 20, 40, 1);
    Image frame = testing::tanh_frame(scene, 20, 1.2, 0, 1);
    RandomStream random(3, "noise");
    for (float& p : frame.pixels()) {
        p = p > 190 ? 255 : p + static_cast<float>(2 * random.normal());
    }
    const double expected = std::hypot(2, std::sqrt(1 / 12.0)) / 225;
    EXPECT_NEAR(edge_noise(frame, model_of({20, 1.2}, 255, 30), scene.position), expected,
                0.02 * expected);
}

TEST(EdgeNoise, OfABlankFrameIsNone) {
    EXPECT_EQ(edge_noise(Image(50, 50, 100), model_of({20, 1.2}, 100, 100), {}), 0);
    EXPECT_EQ(edge_noise(Image(50, 50, 100), model_of({20, 1.2}, 100, 30), {{25, 25}}), 0);
}

}  // namespace
}  // namespace grainfield::tracking
