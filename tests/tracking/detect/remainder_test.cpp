#include "tracking/detect/remainder.h"

#include <algorithm>
#include <cstddef>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

constexpr int kSize = 240;
constexpr DiscProfile kDisc{16, 1.2};

/// The remainder of a liquid, `left_out` of its spheres not in the model; the model is darker than
/// the image by the factor `bright`.
Remainder of_liquid(double noise, std::size_t left_out, float bright = 1) {
    const testing::LayerScene scene = testing::hard_disc_liquid(kSize, kSize, 16, 0.6, 1);
    Image image = testing::tanh_frame(scene, kDisc.diameter, kDisc.edge_width, noise, 1);
    for (float& v : image.pixels()) v = bright * (200 - v) / 170;
    PaddedImage transmission = clear_transmission(kSize, kSize, kDisc);
    place_discs(
        transmission,
        {scene.position.begin() + static_cast<std::ptrdiff_t>(left_out), scene.position.end()},
        kDisc);
    return remainder(padded_darkness(image, kDisc), transmission);
}

TEST(Remainder, OfTheRightModelIsTheNoise) {
    const Remainder left = of_liquid(0.02, 0);
    EXPECT_NEAR(left.noise, 0.02, 0.001);
    EXPECT_NEAR(left.misfit, 0.02 * 0.02, 4e-5);
}

TEST(Remainder, LeavesOutWhatMissingSpheresLeave) {
    const Remainder left = of_liquid(0.02, 10);
    EXPECT_NEAR(left.noise, 0.02, 0.002);
    EXPECT_LT(left.misfit, 2 * 0.02 * 0.02);
}

TEST(Remainder, CountsWhatAWrongModelLeavesAsMisfitAndNotAsNoise) {
    const Remainder left = of_liquid(0.01, 0, 0.85F);
    EXPECT_NEAR(left.noise, 0.01, 0.003);
    EXPECT_GT(left.misfit, 0.08 * 0.08);
}

TEST(Remainder, OfNothingSeenIsNothing) {
    const PaddedImage dark = padded_darkness(Image(kSize, kSize), kDisc);
    PaddedImage hidden = clear_transmission(kSize, kSize, kDisc);
    for (int y = 0; y < kSize; ++y) std::fill_n(hidden.row(y), kSize, 0.0F);
    const Remainder left = remainder(dark, hidden);
    EXPECT_EQ(left.noise, 0);
    EXPECT_EQ(left.misfit, 0);
}

}  // namespace
}  // namespace grainfield::tracking
