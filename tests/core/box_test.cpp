#include "core/box.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "core/errors.h"

namespace grainfield {
namespace {

const Box periodic{{-3, 5}, {10, 4}, {Boundary::periodic, Boundary::periodic}, 0};
const Box walls{{-3, 5}, {10, 4}, {Boundary::walls, Boundary::walls}, 0};

// A double in about ±1e6 with a fraction, from integers that rapidcheck can shrink.
double arbitrary_coordinate() {
    return *rc::gen::inRange<int>(-1000000000, 1000000000) * 1e-3;
}

TEST(Box, MinimumImageIsNeverLongerThanHalfTheBoxAndDiffersByWholeLengths) {
    EXPECT_TRUE(rc::check([] {
        const Vec2 d{arbitrary_coordinate(), arbitrary_coordinate()};
        const Vec2 image = periodic.minimum_image(d);
        RC_ASSERT(std::abs(image.x) <= 5);
        RC_ASSERT(std::abs(image.y) <= 2);
        // |d| ≤ 1e6, so (d − image)/L is a whole number within the rounding of d: 1e6 · 2^-53.
        const double nx = (d.x - image.x) / 10;
        const double ny = (d.y - image.y) / 4;
        RC_ASSERT(std::abs(nx - std::round(nx)) < 1e-10);
        RC_ASSERT(std::abs(ny - std::round(ny)) < 1e-10);
    }));
}

TEST(Box, MinimumImageOfTheOppositeDisplacementIsTheOppositeImage) {
    EXPECT_TRUE(rc::check([] {
        const Vec2 d{arbitrary_coordinate(), arbitrary_coordinate()};
        const Vec2 there = periodic.minimum_image(d);
        const Vec2 back = periodic.minimum_image(d * -1);
        RC_ASSERT(there == back * -1);
    }));
}

TEST(Box, ShortDisplacementsAreTheirOwnImage) {
    EXPECT_EQ(periodic.minimum_image({4.9, -1.9}), (Vec2{4.9, -1.9}));
    EXPECT_EQ(periodic.minimum_image({5.5, 0}), (Vec2{-4.5, 0}));
}

TEST(Box, WalledAxesLeaveDisplacementsAndPointsAlone) {
    EXPECT_EQ(walls.minimum_image({9, -3.5}), (Vec2{9, -3.5}));
    EXPECT_EQ(walls.wrap({100, -100}), (Vec2{100, -100}));
}

TEST(Box, WrappingPutsEveryPointInsideAndIsIdempotent) {
    EXPECT_TRUE(rc::check([] {
        const Vec2 p{arbitrary_coordinate(), arbitrary_coordinate()};
        const Vec2 inside = periodic.wrap(p);
        RC_ASSERT(periodic.contains(inside));
        RC_ASSERT(norm(periodic.wrap(inside) - inside) < 1e-14);
        RC_ASSERT(norm(periodic.minimum_image(inside - p)) < 1e-9);
    }));
}

TEST(Box, WrappingAPointJustBelowTheOriginStaysBelowTheUpperEdge) {
    const double below = std::nextafter(5.0, 0.0);
    EXPECT_TRUE(periodic.contains(periodic.wrap({0, below})));
    EXPECT_TRUE(periodic.contains(periodic.wrap({-3, 9})));
}

TEST(Box, ContainsItsLowerEdgesButNotItsUpperOnes) {
    EXPECT_TRUE(walls.contains({-3, 5}));
    EXPECT_FALSE(walls.contains({7, 6}));
    EXPECT_FALSE(walls.contains({0, 9}));
}

TEST(Box, LengthsMustBeFiniteAndPositiveAndTheHeightNotNegative) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NO_THROW(require_valid(periodic));
    for (const double bad : {0.0, -1.0, nan, std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(require_valid({{0, 0}, {bad, 1}, {}, 0}), OptionError) << bad;
        EXPECT_THROW(require_valid({{0, 0}, {1, bad}, {}, 0}), OptionError) << bad;
    }
    EXPECT_THROW(require_valid({{nan, 0}, {1, 1}, {}, 0}), OptionError);
    EXPECT_THROW(require_valid({{0, 0}, {1, 1}, {}, -0.1}), OptionError);
    EXPECT_THROW(require_valid({{0, 0}, {1, 1}, {}, nan}), OptionError);
}

}  // namespace
}  // namespace grainfield
