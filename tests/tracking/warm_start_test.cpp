#include "tracking/warm_start.h"

#include <cmath>

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

constexpr double kDiameter = 10;

/// A square lattice, 12 px apart.
std::vector<Vec2> lattice(int side) {
    std::vector<Vec2> places;
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) places.push_back({12.0 * x, 12.0 * y});
    }
    return places;
}

std::vector<Vec2> moved(std::vector<Vec2> places, Vec2 by) {
    for (Vec2& p : places) p += by;
    return places;
}

TEST(WarmStart, AStepIsTheRmsDistanceOfNearestDiscs) {
    // 2,500 discs: every third is looked at.
    EXPECT_NEAR(step_between(lattice(50), moved(lattice(50), {0.3, 0.4}), kDiameter), 0.5, 1e-12);
    EXPECT_EQ(step_between(lattice(5), lattice(5), kDiameter), 0);
}

TEST(WarmStart, OfDiscsThatHaveMostlyGoneIsADiameter) {
    EXPECT_EQ(step_between(lattice(9), moved(lattice(9), {6, 6}), kDiameter), kDiameter);
}

TEST(WarmStart, FewThatAreNewDoNotCount) {
    std::vector<Vec2> now = moved(lattice(9), {1, 0});
    now.push_back({6, 6});
    EXPECT_NEAR(step_between(lattice(9), now, kDiameter), 1, 1e-12);
}

TEST(WarmStart, WithoutDiscsNoStepIsKnown) {
    EXPECT_EQ(step_between({}, lattice(3), kDiameter), 0);
    EXPECT_EQ(step_between(lattice(3), {}, kDiameter), 0);
}

}  // namespace
}  // namespace grainfield::tracking
