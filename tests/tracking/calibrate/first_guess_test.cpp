#include "tracking/calibrate/first_guess.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

Image liquid(double diameter) {
    const auto scene = testing::hard_disc_liquid(400, 400, diameter, 0.6, 2);
    return testing::tanh_frame(scene, diameter, 0.08 * diameter, 0.02, 1);
}

std::vector<FirstGuess> guesses(const Image& counts, PolarityChoice polarity) {
    return first_guesses(counts, levels_of(counts), polarity, 0.003);
}

TEST(Levels, AreThoseOfBackgroundAndCoreAndTheNoise) {
    // 200 and 30 counts, noise of 0.02 of the contrast: 3.4 counts, and a rounding of 1/sqrt(12).
    const Levels levels = levels_of(liquid(16));
    const double noise = std::hypot(3.4, 1 / std::sqrt(12.0));
    EXPECT_NEAR(levels.noise, noise, 0.1 * noise);
    // Quantiles of half a percent lie within three standard deviations of the noise.
    EXPECT_NEAR(levels.low, 30, 3 * noise);
    EXPECT_NEAR(levels.high, 200, 3 * noise);
    EXPECT_EQ(blank_reason(levels), "");
}

TEST(Levels, AFewSpheresAreEnough) {
    testing::LayerScene scene = testing::isolated_discs(400, 400, 16, 500, 1);
    scene.position = {{200, 200}};
    const Levels levels = levels_of(testing::tanh_frame(scene, 16, 1.2, 0.02, 1));
    EXPECT_NEAR(levels.low, 30, 5);
    EXPECT_EQ(blank_reason(levels), "");
}

TEST(Levels, OfNothingAreBlank) {
    EXPECT_NE(blank_reason(levels_of(Image(100, 100, 255.0F))), "");
    EXPECT_NE(blank_reason(levels_of(testing::noise_frame(200, 200, 120, 6, 0, 1))), "");
    EXPECT_NE(blank_reason(levels_of(Image(1, 1))), "");
}

TEST(FirstGuess, HasTheSizeAndTheLevelsOfDarkSpheres) {
    for (const double diameter : {8.0, 16.0, 30.0}) {
        const auto found = guesses(liquid(diameter), PolarityChoice::automatic);
        ASSERT_FALSE(found.empty());
        EXPECT_EQ(found[0].polarity, Polarity::dark);
        EXPECT_NEAR(found[0].size.radius, diameter / 2, 0.08 * diameter + 0.5);
        EXPECT_NEAR(found[0].dark_level, 30, 11);
        EXPECT_NEAR(found[0].background(200, 200), 200, 11);
    }
}

TEST(FirstGuess, OfBrightSpheresIsThatOfTheImageTurnedRound) {
    const Image dark = liquid(16);
    const auto of_dark = guesses(dark, PolarityChoice::dark);
    const auto of_bright = guesses(turned_round(dark), PolarityChoice::bright);
    ASSERT_EQ(of_dark.size(), of_bright.size());
    for (std::size_t i = 0; i < of_dark.size(); ++i) {
        EXPECT_EQ(of_bright[i].polarity, Polarity::bright);
        EXPECT_EQ(of_bright[i].size.radius, of_dark[i].size.radius);
        EXPECT_EQ(of_bright[i].dark_level, of_dark[i].dark_level);
    }
    const auto both = guesses(turned_round(dark), PolarityChoice::automatic);
    EXPECT_EQ(both[0].polarity, Polarity::bright) << "the likelier polarity comes first";
}

TEST(FirstGuess, WithoutDiscsIsStillOneOfTheLevels) {
    const auto found = guesses(Image(6, 6, 100.0F), PolarityChoice::dark);
    ASSERT_EQ(found.size(), 1U);
    EXPECT_EQ(found[0].size.radius, 0);
}

}  // namespace
}  // namespace grainfield::tracking
