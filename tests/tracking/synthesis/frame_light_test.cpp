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

TEST(FrameLight, AResidualIsImageLessRenderingUnderTheLight) {
    const Image radiance = some_radiance(20, 20);
    Image brightness = lit(radiance, kLight);
    brightness(7, 8) += 0.25F;
    const Image left = light_residual(brightness, Image(20, 20, 10), radiance, kLight, 1);
    EXPECT_NEAR(left(7, 8), 0.25, 1e-6);
    EXPECT_NEAR(inner_rms(left, 0), 0.25 / 20, 1e-5);
    EXPECT_EQ(inner_rms(left, 10), 0);
}

}  // namespace
}  // namespace grainfield::tracking
