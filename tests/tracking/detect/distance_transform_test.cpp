#include "tracking/detect/distance_transform.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "core/support/random.h"

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

}  // namespace
}  // namespace grainfield::tracking
