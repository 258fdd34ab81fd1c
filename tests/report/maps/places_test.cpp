#include "report/maps/places.h"

#include <limits>

#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

// Spheres on a square lattice of spacing 10, all explained equally well.
Snapshot lattice(int side) {
    Snapshot snapshot;
    for (int i = 0; i < side * side; ++i) {
        snapshot.position.push_back({10.0 * (i % side), 10.0 * (i / side)});
        snapshot.quality.push_back(0.02);
    }
    return snapshot;
}

TEST(Places, AreNoneWhereNothingDiffersOrNothingIsKnown) {
    EXPECT_TRUE(places_to_look_at(lattice(10), 10).empty());
    Snapshot unknown = lattice(10);
    unknown.quality.clear();
    EXPECT_TRUE(places_to_look_at(unknown, 10).empty());
    EXPECT_TRUE(places_to_look_at(Snapshot{}, 10).empty());
}

TEST(Places, JoinNeighboursAndStandWorstFirst) {
    Snapshot snapshot = lattice(10);
    snapshot.quality[0] = 0.09;  // a place of two
    snapshot.quality[1] = 0.2;
    snapshot.quality[99] = 0.5;    // the far corner
    snapshot.quality[50] = 0.075;  // less than four medians
    snapshot.quality[51] = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Place> places = places_to_look_at(snapshot, 10);
    ASSERT_EQ(places.size(), 2U);
    EXPECT_EQ(places[0].position, (Vec2{90, 90}));
    EXPECT_EQ(places[0].spheres, 1);
    EXPECT_EQ(places[1].position, (Vec2{10, 0})) << "of the worse of the two";
    EXPECT_EQ(places[1].spheres, 2);
    EXPECT_DOUBLE_EQ(places[1].residual, 0.2);
}

TEST(Places, ReachOverAChainOfNeighbours) {
    Snapshot snapshot = lattice(10);
    for (std::size_t i = 0; i < 10; ++i)
        snapshot.quality[i] = 0.2 + 0.01 * static_cast<double>(i % 3);
    const std::vector<Place> places = places_to_look_at(snapshot, 10);
    ASSERT_EQ(places.size(), 1U);
    EXPECT_EQ(places[0].spheres, 10);
}

}  // namespace
}  // namespace grainfield::report
