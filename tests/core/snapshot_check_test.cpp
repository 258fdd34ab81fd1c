#include "core/snapshot_check.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield {

namespace {

using ::testing::HasSubstr;

constexpr double infinity = std::numeric_limits<double>::infinity();

Snapshot three() {
    Snapshot s;
    s.box = {.origin = {-0.5, -0.5}, .length = {10, 20}};
    s.position = {{1, 2}, {3, 4}, {5, 6}};
    s.id = {7, 3, 9};
    return s;
}

}  // namespace

TEST(SnapshotCheck, FindsNothingInWhatTrackersAndSimulationsWrite) {
    SnapshotCheck check;
    Snapshot s = three();
    s.position[0] = {-99, 219};  // not folded back: less than ten lengths
    for (int round = 0; round < 3; ++round) EXPECT_FALSE(check.flaw_of(s)) << round;
    s.id.clear();
    EXPECT_FALSE(check.flaw_of(s));
    EXPECT_FALSE(check.flaw_of({}));
}

TEST(SnapshotCheck, FindsPositionsThatAreNoMeasurement) {
    SnapshotCheck check;
    for (const double x : {std::nan(""), infinity, -infinity, 1e300, 50 * 10.0, -50 * 10.0}) {
        Snapshot s = three();
        s.position[1].x = x;
        const auto flaw = check.flaw_of(s);
        ASSERT_TRUE(flaw) << x;
        EXPECT_EQ(flaw->particle, 1U);
        EXPECT_EQ(particle_name(s, flaw->particle), "particle 3");
        EXPECT_THAT(flaw->actual, HasSubstr("it is at ("));
    }
}

TEST(SnapshotCheck, FindsIdentitiesThatOccurTwiceHoweverLarge) {
    SnapshotCheck check;
    for (const std::int64_t large : {std::int64_t{0}, std::int64_t{1} << 40}) {
        Snapshot s = three();
        s.id = {large + 7, large + 3, large + 7};
        const auto flaw = check.flaw_of(s);
        ASSERT_TRUE(flaw) << large;
        EXPECT_EQ(flaw->particle, 2U);
        s.id = {large + 7, large + 3, large + 8};
        EXPECT_FALSE(check.flaw_of(s));
    }
}

TEST(SnapshotCheck, TimesMustGrow) {
    EXPECT_FALSE(first_not_growing({}));
    EXPECT_FALSE(first_not_growing(std::vector<double>{3, 4, 4.5}));
    EXPECT_EQ(first_not_growing(std::vector<double>{3, 4, 4, 5}), 2U);
    EXPECT_EQ(first_not_growing(std::vector<double>{3, 2}), 1U);
    EXPECT_EQ(first_not_growing(std::vector<double>{3, std::nan("")}), 1U);
}

}  // namespace grainfield
