#include "tracking/calibrate/illumination.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"
#include "tracking/model/padded_image.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

ImageModel model_of_tanh_frames() {
    ImageModel model;
    model.disc = {16, 1.2};
    model.background = BackgroundSurface(200);
    model.dark_level = 30;
    return model;
}

PaddedImage transmission_of(const testing::LayerScene& scene, const DiscProfile& disc) {
    PaddedImage t = clear_transmission(scene.width, scene.height, disc);
    for (const Vec2 p : scene.position) place_disc(t, p, disc);
    return t;
}

Image in_light(Image frame, float gain, float offset) {
    for (float& v : frame.pixels()) v = gain * v + offset;
    return frame;
}

TEST(IlluminationFollower, FindsTheLightBeforeAndAfterTheFit) {
    const ImageModel model = model_of_tanh_frames();
    const auto before = testing::hard_disc_liquid(400, 400, 16, 0.6, 1);
    const auto after = testing::hard_disc_liquid(400, 400, 16, 0.6, 2);  // every sphere elsewhere
    IlluminationFollower follower(model);
    const Image first = testing::tanh_frame(before, 16, 1.2, 0.02, 1);
    const Illumination same = follower.expected(first);
    EXPECT_EQ(same.span, 1);
    follower.settled(first, same, transmission_of(before, model.disc));

    // Counts 0.7 I + 5: span 0.7, offset (200 − 0.7 · 200 − 5)/170.
    const Image dim = in_light(testing::tanh_frame(after, 16, 1.2, 0.02, 2), 0.7F, 5);
    const double offset = 55.0 / 170;
    const Illumination guess = follower.expected(dim);
    // One count is .006 of the contrast, and the edges of discs move the ranks within the noise.
    EXPECT_NEAR(guess.offset, offset, 0.02);
    EXPECT_NEAR(guess.span, 0.7, 0.03);
    const Illumination found = follower.settled(dim, guess, transmission_of(after, model.disc));
    // Medians of 3,000 and 8,000 values of noise .014: .0003; counts are whole numbers: .0017.
    EXPECT_NEAR(found.offset, offset, 0.002);
    EXPECT_NEAR(found.span, 0.7, 0.004);

    const Illumination next = follower.expected(dim);
    EXPECT_EQ(next.offset, found.offset);
    EXPECT_EQ(next.span, found.span);
}

TEST(IlluminationFollower, SpheresThatComeAreNotTakenForALampThatDims) {
    const ImageModel model = model_of_tanh_frames();
    const auto few = testing::hard_disc_liquid(400, 400, 16, 0.55, 1);
    const auto many = testing::hard_disc_liquid(400, 400, 16, 0.6, 2);
    IlluminationFollower follower(model);
    const Image first = testing::tanh_frame(few, 16, 1.2, 0.02, 1);
    follower.settled(first, follower.expected(first), transmission_of(few, model.disc));
    const Image second = testing::tanh_frame(many, 16, 1.2, 0.02, 2);
    const Illumination guess = follower.expected(second);
    EXPECT_NEAR(guess.offset, 0, 0.02);
    EXPECT_NEAR(guess.span, 1, 0.03);
    const Illumination found = follower.settled(second, guess, transmission_of(many, model.disc));
    EXPECT_NEAR(found.offset, 0, 0.003);
    EXPECT_NEAR(found.span, 1, 0.004);
}

TEST(IlluminationFollower, ABlackFrameIsNotALight) {
    const ImageModel model = model_of_tanh_frames();
    const auto scene = testing::hard_disc_liquid(200, 200, 16, 0.5, 1);
    IlluminationFollower follower(model);
    const Image first = testing::tanh_frame(scene, 16, 1.2, 0.02, 1);
    follower.settled(first, follower.expected(first), transmission_of(scene, model.disc));
    const Illumination black = follower.expected(Image(200, 200));
    EXPECT_GT(black.span, 0.02);
    EXPECT_TRUE(std::isfinite(black.offset));
}

}  // namespace
}  // namespace grainfield::tracking
