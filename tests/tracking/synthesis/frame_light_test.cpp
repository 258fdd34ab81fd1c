#include "tracking/synthesis/frame_light.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tracking/synthesis/mirror_image.h"

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

double laplacian(const Image& image, int x, int y) {
    return static_cast<double>(image(x - 1, y) + image(x + 1, y) + image(x, y - 1) +
                               image(x, y + 1) - 4 * image(x, y));
}

/// An image whose offset, gain and sharpness change evenly from side to side.
Image unevenly_lit(const Image& radiance, double sharpness) {
    Image image(radiance.width(), radiance.height());
    for (int y = 1; y < image.height() - 1; ++y) {
        for (int x = 1; x < image.width() - 1; ++x) {
            const double u = static_cast<double>(x) / (image.width() - 1);
            const double v = static_cast<double>(y) / (image.height() - 1);
            image(x, y) = static_cast<float>(0.05 * v +
                                             (0.8 + 0.3 * u) * static_cast<double>(radiance(x, y)) +
                                             sharpness * (u - 0.5) * laplacian(radiance, x, y));
        }
    }
    return image;
}

/// Spots some pixels wide, from about 0 to 1.
Image blurred_radiance(int width, int height) {
    Image radiance = gaussian_blurred(some_radiance(width, height), 1.2, 2);
    for (float& v : radiance.pixels()) v = 0.5F + 4 * (v - 0.5F);
    return radiance;
}

double rms_difference(const Image& a, const Image& b) {
    Image difference(a.width(), a.height());
    for (std::size_t i = 0; i < a.size(); ++i) {
        difference.pixels()[i] = a.pixels()[i] - b.pixels()[i];
    }
    return inner_rms(difference, kBorder);
}

TEST(FrameLight, EvenedOutAnImageIsItsRadianceWhateverOffsetGainAndFocusAre) {
    const Image radiance = blurred_radiance(200, 160);
    const LightNodes nodes{.spacing = 60, .has_sharpness = true, .border = kBorder};
    Image brightness = unevenly_lit(radiance, 0.3);
    Image ceiling(200, 160, 10);
    EXPECT_GT(rms_difference(brightness, radiance), 0.04);
    even_out(brightness, ceiling, radiance, nodes);
    EXPECT_LT(rms_difference(brightness, radiance), 1e-3);
    EXPECT_NEAR(ceiling(10, 80), (10 - 0.025) / 0.815, 0.1);
    EXPECT_NEAR(ceiling(190, 80), (10 - 0.025) / 1.085, 0.1);
}

TEST(FrameLight, TheFocusIsEvenedOutOnlyIfAskedFor) {
    const Image radiance = blurred_radiance(200, 160);
    const LightNodes nodes{.spacing = 60, .has_sharpness = false, .border = kBorder};
    Image brightness = unevenly_lit(radiance, 0);
    Image ceiling(200, 160, 10);
    even_out(brightness, ceiling, radiance, nodes);
    EXPECT_LT(rms_difference(brightness, radiance), 1e-3);
    brightness = unevenly_lit(radiance, 0.3);
    even_out(brightness, ceiling, radiance, nodes);
    EXPECT_GT(rms_difference(brightness, radiance), 5e-3);
}

TEST(FrameLight, WhatIsFarFromTheRenderingOrAtTheCeilingDoesNotEvenOut) {
    const Image radiance = some_radiance(200, 160);
    const LightNodes nodes{.spacing = 60, .has_sharpness = false, .border = kBorder};
    Image brightness = unevenly_lit(radiance, 0);
    Image ceiling(200, 160, 0.85F);
    for (float& v : brightness.pixels()) v = std::min(v, 0.85F);
    for (int x = 60; x < 90; ++x) {
        for (int y = 60; y < 70; ++y) brightness(x, y) -= 0.4F;  // a sphere that is not rendered
    }
    even_out(brightness, ceiling, radiance, nodes);
    EXPECT_NEAR(brightness(75, 90), std::min(radiance(75, 90), ceiling(75, 90)), 0.01F);
    EXPECT_LT(brightness(75, 65), radiance(75, 65) - 0.3F);
}

}  // namespace
}  // namespace grainfield::tracking
