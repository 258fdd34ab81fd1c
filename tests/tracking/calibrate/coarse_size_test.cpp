#include "tracking/calibrate/coarse_size.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

TEST(DistanceTransform, EqualsBruteForce) {
    RandomStream random(7, "mask");
    Image mask(37, 23);
    for (float& v : mask.pixels()) v = random.uniform() < 0.9 ? 1.0F : 0.0F;
    const Image distance = squared_distance_transform(mask);
    for (int y = 0; y < 23; ++y) {
        for (int x = 0; x < 37; ++x) {
            float nearest = 3600;
            for (int v = 0; v < 23; ++v) {
                for (int u = 0; u < 37; ++u) {
                    if (mask(u, v) > 0.5F) continue;
                    nearest = std::min(nearest,
                                       static_cast<float>((x - u) * (x - u) + (y - v) * (y - v)));
                }
            }
            ASSERT_EQ(distance(x, y), nearest) << x << ' ' << y;
        }
    }
}

TEST(DistanceTransform, OfAFullMaskIsFarEverywhere) {
    const Image distance = squared_distance_transform(Image(8, 5, 1.0F));
    for (const float d : distance.pixels()) EXPECT_EQ(d, 169.0F);
}

TEST(CoarseSize, FindsTheRadiusOfDiscsAndCoversThem) {
    for (const double diameter : {6.0, 16.0, 40.0}) {
        const auto scene = testing::hard_disc_liquid(600, 600, diameter, 0.6, 4);
        const Image frame = testing::tanh_frame(scene, diameter, 0.08 * diameter, 0.02, 1);
        Image mask(600, 600);
        Image gaps(600, 600);
        for (std::size_t i = 0; i < mask.size(); ++i) {
            mask.pixels()[i] = frame.pixels()[i] < 115 ? 1.0F : 0.0F;
            gaps.pixels()[i] = 1 - mask.pixels()[i];
        }
        const CoarseSize size = coarse_sizes(mask).at(0);
        EXPECT_NEAR(size.radius, diameter / 2, 0.08 * diameter + 0.5) << diameter;
        EXPECT_GT(size.coverage, 1.5 * coarse_sizes(gaps).at(0).coverage) << diameter;
    }
}

TEST(CoarseSize, OfAnEmptyMaskIsNothing) {
    EXPECT_TRUE(coarse_sizes(Image(20, 20)).empty());
}

}  // namespace
}  // namespace grainfield::tracking
