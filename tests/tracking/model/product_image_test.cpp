#include "tracking/model/product_image.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"
#include "tracking/locate.h"
#include "tracking/model/blurred_union.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

constexpr double kDiameter = 16;
/// What the tanh edge makes of an opaque disc of 16 px blurred by σ = 0.06 D and sampled by pixels.
const DiscProfile kDisc{15.87, 1.18};

/// The blurred union of two opaque discs `separation` apart, by area coverage on a finer grid,
/// almost without noise: darkness.
Image pair_image(Vec2 first, Vec2 second) {
    testing::Camera camera;
    camera.apparent_diameter = 1;
    camera.rim_darkness = 1;
    camera.blur = 0.0598;
    camera.vignetting = 0;
    camera.electrons = 1e8;
    camera.read_noise = 0;
    camera.bit_depth = 16;
    testing::LayerScene scene{96, 80, kDiameter, {first, second}, {}, 0};
    Image image = testing::camera_frame(scene, camera, 1);
    const auto bright = static_cast<float>(0.9 * 65535);
    for (float& v : image.pixels()) v = (1 - v / bright) / 0.94F;
    return image;
}

/// How far the distance found is from the true one, per sphere and along the pair [px].
double shift_along_pair(double separation, double angle, const OverlapRule& rule) {
    const Vec2 middle{47.3, 39.6};
    const Vec2 half = (separation * kDiameter / 2) * Vec2{std::cos(angle), std::sin(angle)};
    Locator locator(96, 80, {kDisc, rule}, 1);
    RefinementOptions fine;
    fine.tolerance = 1e-4;
    const Located found = locator.locate(pair_image(middle - half, middle + half), {}, fine,
                                         {middle - half, middle + half});
    if (found.position.size() != 2) return 100;
    return (norm(found.position[0] - found.position[1]) - separation * kDiameter) / 2;
}

TEST(BlurredUnion, KeepsSpheresApartByTheirTrueDistance) {
    for (const double separation : {0.5, 0.6, 0.75, 0.85, 0.95, 1.0, 1.05, 1.15, 1.3}) {
        for (const double angle : {0.3, 1.1}) {
            // The bound of the docstring, with the edge that is no tanh.
            EXPECT_LT(std::abs(shift_along_pair(separation, angle, kBlurredUnion)),
                      0.0015 * kDiameter)
                << separation << ' ' << angle;
        }
    }
    // What it is for: the product pulls spheres that touch together.
    EXPECT_LT(shift_along_pair(1.0, 0.3, kProductRule), -0.05);
}

TEST(ProductImage, OneDiscMeetsNothing) {
    const std::vector<Vec2> one{{30.2, 31.7}};
    PaddedImage transmission = clear_transmission(64, 64, kDisc);
    place_disc(transmission, one[0], kDisc);
    const Image darkness(64, 64, 0.25F);
    const Image product = product_image(darkness, one, {kDisc, kBlurredUnion}, 1);
    for (std::size_t i = 0; i < product.size(); ++i) {
        EXPECT_NEAR(product.pixels()[i], darkness.pixels()[i], 1e-6F);
    }
}

// An image of the learned profile is, seen this way, one of tanh discs.
TEST(ProductImage, TakesTheLearnedProfileOutOfTheImage) {
    const RadialCorrection rim{2, {0.01F, 0.01F, -0.02F, -0.1F, -0.05F, 0.03F, 0}};
    const std::vector<Vec2> pair{{24.2, 31.7}, {36.9, 34.1}};
    PaddedImage transmission = clear_transmission(64, 64, kDisc);
    for (const Vec2 p : pair) place_disc(transmission, p, kDisc);
    Image darkness(64, 64);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) {
            double light = 1;
            for (const Vec2 p : pair) {
                const double r = std::hypot(x - p.x, y - p.y);
                if (r < kDisc.reach()) {
                    light *=
                        1 - kDisc.darkness(r) - static_cast<double>(rim(static_cast<float>(r)));
                }
            }
            darkness(x, y) = static_cast<float>(1 - light);
        }
    }
    const Image product = product_image(darkness, pair, {kDisc, kProductRule, rim}, 1);
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) EXPECT_NEAR(product(x, y), 1 - transmission(x, y), 1e-5F);
    }
}

TEST(ProductImage, IsTheSameForAnyNumberOfThreads) {
    const auto scene = testing::hard_disc_liquid(300, 260, kDiameter, 0.7, 1);
    PaddedImage transmission = clear_transmission(300, 260, kDisc);
    for (const Vec2 p : scene.position) place_disc(transmission, p, kDisc);
    const Image darkness(300, 260, 0.5F);
    const Image one = product_image(darkness, scene.position, {kDisc, kBlurredUnion}, 1);
    EXPECT_EQ(one, product_image(darkness, scene.position, {kDisc, kBlurredUnion}, 2));
    EXPECT_EQ(one, product_image(darkness, scene.position, {kDisc, kBlurredUnion}, 8));
    const RadialCorrection rim{2, {0, 0.01F, -0.02F, -0.1F, -0.05F, 0.03F, 0}};
    const auto learned = [&](int threads) {
        return product_image(darkness, scene.position, {kDisc, kBlurredUnion, rim}, threads);
    };
    EXPECT_NE(one, learned(1));
    EXPECT_EQ(learned(1), learned(2));
    EXPECT_EQ(learned(1), learned(8));
}

}  // namespace
}  // namespace grainfield::tracking
