#include "tracking/detect/local_maxima.h"

#include <cmath>

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

Image bumps(const std::vector<Vec2>& centres) {
    Image map(60, 40);
    for (int y = 0; y < 40; ++y) {
        for (int x = 0; x < 60; ++x) {
            for (std::size_t i = 0; i < centres.size(); ++i) {
                const double r2 = squared_norm(centres[i] - Vec2{double(x), double(y)});
                map(x, y) += static_cast<float>((1 + 0.1 * double(i)) * std::exp(-r2 / 18));
            }
        }
    }
    return map;
}

TEST(LocalMaxima, AreFoundToAFractionOfAPixelHighestFirst) {
    const std::vector<Vec2> centres{{12.3, 10.7}, {40.1, 25.45}};
    const auto peaks = local_maxima(bumps(centres), 0.5F, 5);
    ASSERT_EQ(peaks.size(), 2u);
    EXPECT_NEAR(peaks[0].position.x, 40.1, 0.02);
    EXPECT_NEAR(peaks[0].position.y, 25.45, 0.02);
    EXPECT_NEAR(peaks[1].position.x, 12.3, 0.02);
}

TEST(LocalMaxima, OfTwoCloserThanTheSeparationTheHigherStays) {
    const auto map = bumps({{20, 20}, {27, 20}});
    EXPECT_EQ(local_maxima(map, 0.2F, 3).size(), 2u);
    const auto peaks = local_maxima(map, 0.2F, 9);
    ASSERT_EQ(peaks.size(), 1u);
    // The tails of the lower bump pull the maximum a little towards it.
    EXPECT_NEAR(peaks[0].position.x, 27, 1);
}

TEST(LocalMaxima, APlateauCountsOnce) {
    Image map(10, 10);
    map(4, 4) = map(5, 4) = map(4, 5) = 1;
    EXPECT_EQ(local_maxima(map, 0.5F, 1).size(), 1u);
}

TEST(LocalMaxima, AtTheBorderAreReported) {
    Image map(10, 10);
    map(0, 9) = 1;
    const auto peaks = local_maxima(map, 0.5F, 4);
    ASSERT_EQ(peaks.size(), 1u);
    EXPECT_EQ(peaks[0].position, (Vec2{0, 9}));
}

}  // namespace
}  // namespace grainfield::tracking
