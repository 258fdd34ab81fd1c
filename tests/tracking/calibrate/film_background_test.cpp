#include "tracking/calibrate/film_background.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

const FilmLevels kLevels{.sign = 1, .core = 30, .contrast = 170, .noise = 3.4, .reach = 4};

/// A window that dims by a smooth shade, a speck in the middle, and a pixel that blocks all light.
double window(int x, int y) {
    if (x == 60 && y == 20) return 0;
    const double shade = 1 - 0.1 * x / 80;
    return shade * (std::hypot(x - 30, y - 30) < 6 ? 0.5 : 1);
}

/// Frames in which each pixel is covered with the chance `covered`.
ClearLevelEstimator film(double covered, int frames) {
    RandomStream random(5, "film");
    ClearLevelEstimator estimator(80, 64);
    for (int f = 0; f < frames; ++f) {
        Image image(80, 64);
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 80; ++x) {
                const double light = random.uniform() < covered ? 0 : window(x, y);
                image(x, y) = static_cast<float>(30 + 170 * light + 3.4 * random.normal());
            }
        }
        estimator.add(image);
    }
    return estimator;
}

TEST(FilmBackground, FindsTheClearLevelBehindWhatCovers) {
    for (const double covered : {0.0, 0.5, 0.6}) {
        const ClearLevels clear = film(covered, 48).estimate(kLevels, 2);
        double pull = 0;
        double bias = 0;
        int n = 0;
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 80; ++x) {
                if (x == 60 && y == 20) continue;
                ASSERT_TRUE(std::isfinite(clear.level(x, y))) << x << ' ' << y << ' ' << covered;
                const double error =
                    static_cast<double>(clear.level(x, y)) - (30 + 170 * window(x, y));
                pull += std::pow(error / static_cast<double>(clear.error(x, y)), 2);
                bias += error;
                ++n;
            }
        }
        // 5,119 pulls: their RMS scatters by 1 %, the mean error by 0.01 counts.
        EXPECT_NEAR(std::sqrt(pull / n), 1, 0.1) << covered;
        EXPECT_LT(std::abs(bias / n), 0.1) << covered;
        EXPECT_FALSE(std::isfinite(clear.level(60, 20)));
    }
}

TEST(FilmBackground, EvensOutTheSpeckAndLeavesTheShadeAndWhatIsNeverClear) {
    const Evening evening = evening_of(film(0.5, 48).estimate(kLevels, 2), kLevels);
    EXPECT_NEAR(evening.gain(30, 30), 2, 0.1);
    EXPECT_EQ(evening.gain(60, 20), 1);
    EXPECT_EQ(evening.gain(63, 20), 1) << "within reach of an edge";
    EXPECT_NEAR(evening.never_clear, 1.0 / (80 * 64), 1e-6);
    EXPECT_NEAR(evening.strongest, 0.5, 0.08);
    int elsewhere = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 80; ++x) {
            elsewhere += std::hypot(x - 30, y - 30) > 7 && evening.gain(x, y) != 1;
        }
    }
    // Four standard errors: 6e-5 of the pixels, and what the surface does not follow.
    EXPECT_LT(elsewhere, 20);
}

TEST(FilmBackground, WhatAMaskHidesCountsInNoShareAndNoSurface) {
    // A strip along the left border, as wide as a third of the frame: another light, and blocked
    // in places.
    const int hidden = 26;
    ClearLevels clear = film(0.5, 48).estimate(kLevels, 2);
    const Evening undisturbed = evening_of(clear, kLevels);
    Image mask(80, 64, 1);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < hidden; ++x) {
            mask(x, y) = 0;
            clear.level(x, y) =
                x < 20 && y % 2 == 0 ? std::numeric_limits<float>::quiet_NaN() : 90.0F;
        }
    }
    const Evening disturbed = evening_of(clear, kLevels);
    ASSERT_GT(disturbed.never_clear, 0.12) << "nothing for the mask to do";
    const Evening masked = evening_of(clear, kLevels, VisiblePixels(mask));
    EXPECT_NEAR(masked.never_clear, 1.0 / ((80 - hidden) * 64), 1e-6);
    EXPECT_NEAR(masked.strongest, undisturbed.strongest, 0.03);
    int uneven = 0;
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 80; ++x) {
            if (x < hidden) {
                EXPECT_EQ(masked.gain(x, y), 1);
            } else {
                // The tiles of the strip are missing to the surface, no more.
                EXPECT_NEAR(masked.gain(x, y), undisturbed.gain(x, y), 0.03) << x << ' ' << y;
                uneven += masked.gain(x, y) != 1;
            }
        }
    }
    EXPECT_NEAR(masked.uneven, uneven / ((80.0 - hidden) * 64), 1e-9);
}

TEST(FilmBackground, WithoutATileThatIsHalfKnownNothingIsEvened) {
    ClearLevels clear{Image(80, 64, std::numeric_limits<float>::quiet_NaN()), Image(80, 64, 1)};
    clear.level(40, 30) = 200;
    const Evening evening = evening_of(clear, kLevels);
    EXPECT_EQ(evening.gain, Image(80, 64, 1));
    EXPECT_EQ(evening.uneven, 0);
    EXPECT_NEAR(evening.never_clear, 1 - 1.0 / (80 * 64), 1e-9);
}

TEST(FilmBackground, BrightSpheresAreTheSameTurnedRound) {
    const FilmLevels bright{.sign = -1, .core = 225, .contrast = 170, .noise = 3.4, .reach = 4};
    const ClearLevelEstimator dark = film(0.5, 20);
    ClearLevelEstimator turned(80, 64);
    RandomStream random(5, "film");
    for (int f = 0; f < 20; ++f) {
        Image image(80, 64);
        for (int y = 0; y < 64; ++y) {
            for (int x = 0; x < 80; ++x) {
                const double light = random.uniform() < 0.5 ? 0 : window(x, y);
                image(x, y) =
                    255 - std::round(static_cast<float>(30 + 170 * light + 3.4 * random.normal()));
            }
        }
        turned.add(image);
    }
    const Image a = dark.estimate(kLevels, 1).level;
    const Image b = turned.estimate(bright, 1).level;
    for (std::size_t i = 0; i < a.size(); ++i) {
        if (!std::isfinite(a.pixels()[i])) continue;
        EXPECT_NEAR(255 - b.pixels()[i], a.pixels()[i], 1e-3);
    }
}

TEST(FilmBackground, ASphereOverASpeckIsAsDarkAsElsewhere) {
    Image gain(2, 1, 1);
    gain(0, 0) = 2;
    Image counts(2, 1);
    counts(0, 0) = 30 + 0.5F * 0.4F * 170;
    counts(1, 0) = 30 + 0.4F * 170;
    even_out(counts, gain, kLevels);
    EXPECT_NEAR(counts(0, 0), counts(1, 0), 1e-4);
}

}  // namespace
}  // namespace grainfield::tracking
