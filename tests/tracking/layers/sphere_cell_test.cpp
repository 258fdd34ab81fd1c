#include "tracking/layers/sphere_cell.h"

#include <vector>

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

constexpr double kA = 10;
const SphereCell kCell{.diameter = kA, .height = 1.94};

TEST(SphereCell, APairNearerThanTheLeastDistanceHasNone) {
    const double least = kCell.least_distance() * kA;
    EXPECT_TRUE(has_room(kCell, {0, 0}, {{1.001 * least, 0}}, 0));
    EXPECT_FALSE(has_room(kCell, {0, 0}, {{0.999 * least, 0}}, 0));
    EXPECT_TRUE(has_room(kCell, {0, 0}, {{0.999 * least, 0}}, 0.01));
}

TEST(SphereCell, OfThreeAllNearerThanTheLeastOfThreeNoneHas) {
    const double side = kCell.least_of_three() * kA;
    const auto triangle = [](double s) {
        return std::vector<Vec2>{{s, 0}, {0.5 * s, 0.866025404 * s}};
    };
    EXPECT_TRUE(has_room(kCell, {0, 0}, triangle(1.001 * side), 0));
    EXPECT_FALSE(has_room(kCell, {0, 0}, triangle(0.999 * side), 0));
}

TEST(SphereCell, ASphereBelowTwoThatTouchHasRoom) {
    EXPECT_TRUE(has_room(kCell, {0, 0}, {{0.5 * kA, 0}, {-0.5 * kA, 0}}, 0));
    // Two beside it do not touch one another: what one asks for does not add to the other.
    EXPECT_TRUE(has_room(kCell, {0, 0}, {{0.4 * kA, 0}, {-0.7 * kA, 0}}, 0));
}

TEST(SphereCell, HalfASplitSphereOfACrystalHasNone) {
    // A square bilayer of spacing 0.8 a; the sphere at the origin is split along x.
    const Vec2 half{-0.25 * kA, 0};
    std::vector<Vec2> others{{0.25 * kA, 0}, {0, 0.8 * kA}, {0, -0.8 * kA}, {-0.8 * kA, 0}};
    EXPECT_FALSE(has_room(kCell, half, others, 0));
    others.erase(others.begin());
    EXPECT_TRUE(has_room(kCell, {0, 0}, others, 0));
}

TEST(SphereCell, AThickerCellHasMore) {
    SphereCell thick = kCell;
    thick.height = 2.2;
    EXPECT_TRUE(has_room(thick, {0, 0}, {{0.1 * kA, 0}}, 0));
}

}  // namespace
}  // namespace grainfield::tracking
