#include "tracking/model/disc_profile.h"

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

TEST(DiscProfile, IsHalfAtTheRadiusAndFollowsTanh) {
    const DiscProfile disc{16, 1.2};
    EXPECT_DOUBLE_EQ(disc.darkness(8), 0.5);
    for (const double r : {0.0, 5.0, 7.5, 8.3, 10.0, 14.0}) {
        EXPECT_NEAR(disc.darkness(r), 0.5 * (1 - std::tanh((r - 8) / 1.2)), 1e-14);
    }
}

TEST(DiscProfile, SlopeIsTheDerivative) {
    const DiscProfile disc{10, 1.5};
    for (const double r : {2.0, 4.0, 5.0, 6.5}) {
        const double h = 1e-5;
        EXPECT_NEAR(disc.slope(r), -(disc.darkness(r + h) - disc.darkness(r - h)) / (2 * h), 1e-9);
    }
}

TEST(DiscProfile, BeyondItsReachTheDiscIsBelowAThousandth) {
    const DiscProfile disc{16, 1.2};
    EXPECT_LT(disc.darkness(disc.reach()), 1e-3);
}

}  // namespace
}  // namespace grainfield::tracking
