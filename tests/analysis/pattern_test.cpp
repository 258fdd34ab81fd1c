#include "analysis/pattern.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::analysis {
namespace {

Snapshot three_particles() {
    Snapshot s;
    s.box = {{-0.5, -0.5}, {100, 50}, {Boundary::walls, Boundary::walls}, 20};
    s.position = {{10, 20}, {std::numeric_limits<double>::quiet_NaN(), 3}, {30, 40}};
    s.id = {7, 8, 9};
    return s;
}

TEST(Pattern, IsInUnitsOfTheDiameter) {
    const Pattern p = pattern_of(three_particles(), 10);
    EXPECT_EQ(p.box.length, (Vec2{10, 5}));
    EXPECT_EQ(p.box.origin, (Vec2{-0.05, -0.05}));
    EXPECT_DOUBLE_EQ(p.box.height, 2);
    EXPECT_EQ(p.position[0], (Vec2{1, 2}));
}

TEST(Pattern, LeavesOutPositionsThatAreNotNumbersAndKeepsIdentities) {
    const Pattern p = pattern_of(three_particles(), 10);
    ASSERT_EQ(p.size(), 2U);
    EXPECT_EQ(p.dropped, 1);
    EXPECT_EQ(p.id, (std::vector<std::int64_t>{7, 9}));
}

TEST(Pattern, RefusesInconsistentColumnsAndUselessDiameters) {
    Snapshot s = three_particles();
    s.id.pop_back();
    EXPECT_THROW(pattern_of(s, 10), InputError);
    TrajectoryInfo info;
    info.diameter = 0;
    EXPECT_THROW(diameter_of(info), InputError);
    info.diameter = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(diameter_of(info), InputError);
}

TEST(Pattern, IsWrappedIntoPeriodicBoxes) {
    Snapshot s;
    s.box = {{0, 0}, {10, 10}, {Boundary::periodic, Boundary::walls}, 0};
    s.position = {{-1, -1}};
    const Pattern p = pattern_of(s, 1);
    EXPECT_EQ(p.position[0], (Vec2{9, -1}));
}

TEST(Pattern, KnowsOnlyHeightsWithAUsefulError) {
    Snapshot snapshot;
    snapshot.box.length = {40, 40};
    snapshot.position = {{5, 5}, {9, 9}, {std::nan(""), 1}, {20, 20}};
    snapshot.z = {4, 6, 8, std::nan("")};
    snapshot.z_error = {1.5, 1.7, 0.1, 0.1};
    const Pattern pattern = pattern_of(snapshot, 8);
    ASSERT_EQ(pattern.z.size(), 3U);
    EXPECT_EQ(pattern.z[0], 0.5);
    EXPECT_TRUE(std::isnan(pattern.z[1]));
    EXPECT_TRUE(std::isnan(pattern.z[2]));
    snapshot.z_error = {3, 3, 3, 3};
    EXPECT_TRUE(pattern_of(snapshot, 8).z.empty());
    snapshot.z_error.pop_back();
    EXPECT_THROW(pattern_of(snapshot, 8), InputError);
    snapshot.z_error.clear();
    snapshot.z.pop_back();
    EXPECT_THROW(pattern_of(snapshot, 8), InputError);
}

}  // namespace
}  // namespace grainfield::analysis
