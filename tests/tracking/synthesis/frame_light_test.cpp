#include "tracking/synthesis/frame_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

constexpr FrameLight kLight{.offset = 0.02, .gain = 0.95, .fall = -0.1};

Image some_radiance(int width, int height) {
    RandomStream random(3, "radiance");
    Image radiance(width, height);
    for (float& v : radiance.pixels()) v = static_cast<float>(random.uniform());
    return radiance;
}

Image lit(const Image& radiance, const FrameLight& light) {
    Image image(radiance.width(), radiance.height());
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            image(x, y) = static_cast<float>(
                light(static_cast<double>(radiance(x, y)), from_middle(image, x, y)));
        }
    }
    return image;
}

TEST(FrameLight, DistancesFromTheMiddleAreInHalfDiagonals) {
    const Image frame(41, 21);
    EXPECT_EQ(from_middle(frame, 20, 10), 0);
    EXPECT_NEAR(from_middle(frame, 0, 0), 1, 0.1);
    EXPECT_EQ(from_middle(frame, 0, 0), from_middle(frame, 40, 20));
    EXPECT_NEAR(from_middle(frame, 20, 0), 100.0 / (0.25 * (41 * 41 + 21 * 21)), 1e-12);
}

TEST(FrameLight, TheLightThatMadeAnImageIsFoundAgain) {
    const Image radiance = some_radiance(60, 50);
    const Image ceiling(60, 50, 10);
    const FrameLight found = fit_light(lit(radiance, kLight), ceiling, radiance, 3);
    EXPECT_NEAR(found.offset, kLight.offset, 1e-5);
    EXPECT_NEAR(found.gain, kLight.gain, 1e-5);
    EXPECT_NEAR(found.fall, kLight.fall, 1e-5);
}

TEST(FrameLight, SaturatedPixelsAndTheBorderHaveNoSay) {
    const Image radiance = some_radiance(60, 50);
    Image brightness = lit(radiance, kLight);
    const Image ceiling(60, 50, 0.7F);
    for (float& v : brightness.pixels()) v = std::min(v, 0.7F);
    brightness(1, 30) = -5;
    const FrameLight found = fit_light(brightness, ceiling, radiance, 2);
    EXPECT_NEAR(found.gain, kLight.gain, 1e-4);
    const Image left = light_residual(brightness, ceiling, radiance, kLight, 2);
    EXPECT_LT(inner_rms(left, 2), 1e-6);
    EXPECT_GT(inner_rms(left, 0), 0.05);
}

// Of 10,000 pixels; a product of neighbours has the standard deviation σ²/√20,000.
TEST(FrameLight, NeighboursShareAWaveAndNoNoise) {
    RandomStream random(5, "noise");
    Image noise(100, 100);
    Image wave(100, 100);
    for (int y = 0; y < 100; ++y) {
        for (int x = 0; x < 100; ++x) {
            noise(x, y) = static_cast<float>(random.normal());
            wave(x, y) = static_cast<float>(std::sin(0.2 * x) + std::cos(0.2 * y));
        }
    }
    EXPECT_NEAR(inner_rms(noise, 2), 1, 0.05);
    EXPECT_LT(coherent_rms(noise, 2), 0.2);
    EXPECT_NEAR(coherent_rms(wave, 2) / inner_rms(wave, 2), 1, 0.02);
    EXPECT_EQ(coherent_rms(noise, 50), 0);
}

TEST(FrameLight, AResidualIsImageLessRenderingUnderTheLight) {
    const Image radiance = some_radiance(20, 20);
    Image brightness = lit(radiance, kLight);
    brightness(7, 8) += 0.25F;
    const Image left = light_residual(brightness, Image(20, 20, 10), radiance, kLight, 1);
    EXPECT_NEAR(left(7, 8), 0.25, 1e-6);
    EXPECT_NEAR(inner_rms(left, 0), 0.25 / 20, 1e-5);
    EXPECT_EQ(inner_rms(left, 10), 0);
}

constexpr int kBorder = 8;
constexpr double kSpacing = 60;

/// Offset and gain change evenly from side to side, the gain by a factor of two.
Image unevenly_lit(const Image& radiance) {
    Image image(radiance.width(), radiance.height());
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            const float u = static_cast<float>(x) / static_cast<float>(image.width() - 1);
            const float v = static_cast<float>(y) / static_cast<float>(image.height() - 1);
            image(x, y) = 0.05F * v + (0.6F + 0.6F * u) * radiance(x, y);
        }
    }
    return image;
}

double rms_difference(const Image& a, const Image& b) {
    Image difference(a.width(), a.height());
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference.pixels()[i] = a.pixels()[i] - b.pixels()[i];
    }
    return inner_rms(difference, kBorder);
}

TEST(FrameLight, EvenedOutAnImageIsItsRadianceWhereTheGainDoublesFromSideToSide) {
    const Image radiance = some_radiance(200, 160);
    const Image image = unevenly_lit(radiance);
    Image brightness = image;
    Image ceiling(200, 160, 10);
    EXPECT_GT(rms_difference(brightness, radiance), 0.1);
    const UnevenLight found = even_out(brightness, ceiling, radiance, kSpacing, kBorder);
    EXPECT_LT(rms_difference(brightness, radiance), 2e-3);
    EXPECT_NEAR(ceiling(0, 80), (10 - 0.025) / 0.6, 0.05);
    EXPECT_NEAR(ceiling(199, 80), (10 - 0.025) / 1.2, 0.05);
    EXPECT_NEAR(found.uneven(brightness(33, 44), 33, 44), image(33, 44), 1e-5);
}

TEST(FrameLight, WhatIsFarFromTheRenderingOrAtTheCeilingDoesNotEvenOut) {
    const Image radiance = some_radiance(200, 160);
    Image brightness = unevenly_lit(radiance);
    Image ceiling(200, 160, 0.85F);
    for (float& v : brightness.pixels()) v = std::min(v, 0.85F);
    for (int x = 60; x < 90; ++x) {
        for (int y = 60; y < 70; ++y) brightness(x, y) -= 0.4F;  // a sphere that is not rendered
    }
    const UnevenLight found = even_out(brightness, ceiling, radiance, kSpacing, kBorder);
    for (const int x : {20, 75, 180}) {
        EXPECT_NEAR(found.gain(x, 65), 0.6 + 0.6 * x / 199, 0.02) << x;
        EXPECT_NEAR(found.offset(x, 65), 0.05 * 65 / 159, 0.01) << x;
    }
}

TEST(FrameLight, ImagesThatTellNothingStayAsTheyAre) {
    const auto stays = [](Image brightness, Image ceiling, const Image& radiance) {
        const Image before = brightness;
        const UnevenLight found = even_out(brightness, ceiling, radiance, kSpacing, kBorder);
        return found.gain.empty() && brightness.pixels() == before.pixels() &&
               found.uneven(0.5F, 0, 0) == 0.5F;
    };
    EXPECT_TRUE(stays(Image(1, 1, 0.5F), Image(1, 1, 10), Image(1, 1, 0.5F)));
    EXPECT_TRUE(stays(Image(16, 300, 0.5F), Image(16, 300, 10), some_radiance(16, 300)));
    const Image radiance = some_radiance(200, 160);
    EXPECT_TRUE(stays(Image(200, 160, 0.5F), Image(200, 160, 0.4F), radiance));  // all saturated
    Image negative = radiance;
    for (float& v : negative.pixels()) v = 1 - v;
    EXPECT_TRUE(stays(negative, Image(200, 160, 10), radiance));
}

}  // namespace
}  // namespace grainfield::tracking
