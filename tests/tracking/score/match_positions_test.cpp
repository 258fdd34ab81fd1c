#include "tracking/score/match_positions.h"

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

using Partners = std::vector<int>;

TEST(MatchPositions, LeavesAloneWhatHasNoPartnerWithinTheGate) {
    const std::vector<Vec2> truth{{10, 10}, {20, 20}, {30, 30}};
    const std::vector<Vec2> found{{10.3, 10}, {29.7, 30}, {50, 50}};
    EXPECT_EQ(match_positions(found, truth, 2), (Partners{0, -1, 1}));
    EXPECT_EQ(match_positions(found, truth, 0.2), (Partners{-1, -1, -1}));
    EXPECT_EQ(match_positions({}, truth, 2), (Partners{-1, -1, -1}));
    EXPECT_TRUE(match_positions(found, {}, 2).empty());
}

TEST(MatchPositions, NearestPairsGoFirstAndOneToOne) {
    EXPECT_EQ(match_positions({{10.0, 10}}, {{9, 10}, {10.5, 10}}, 4), (Partners{-1, 0}));
}

TEST(MatchPositions, EqualDistancesGoToTheSmallerIndices) {
    EXPECT_EQ(match_positions({{1, 0}, {-1, 0}}, {{0, 0}}, 4), (Partners{0}));
    EXPECT_EQ(match_positions({{0, 0}}, {{1, 0}, {-1, 0}}, 4), (Partners{0, -1}));
}

}  // namespace
}  // namespace grainfield::tracking
