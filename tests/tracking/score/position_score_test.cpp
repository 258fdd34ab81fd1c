#include "tracking/score/position_score.h"

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

TEST(PositionScore, CountsMatchedMissedAndSpurious) {
    const std::vector<Vec2> truth{{10, 10}, {20, 20}, {30, 30}};
    const std::vector<Vec2> found{{10.3, 10}, {29.7, 30}, {50, 50}};
    const PositionScore s = score_positions(found, truth, 2, 100, 100, 0);
    EXPECT_EQ(s.matched, 2);
    EXPECT_EQ(s.missed, 1);
    EXPECT_EQ(s.spurious, 1);
    EXPECT_DOUBLE_EQ(s.recall(), 2.0 / 3);
    EXPECT_NEAR(s.rms, 0.3 / std::sqrt(2.0), 1e-12);
    EXPECT_NEAR(s.bias.x, 0, 1e-12);
    EXPECT_EQ(s.partner[1], -1);
}

TEST(PositionScore, NearestPairsGoFirstAndOneToOne) {
    const PositionScore s = score_positions({{10.0, 10}}, {{9, 10}, {10.5, 10}}, 4, 100, 100, 0);
    EXPECT_EQ(s.partner[0], -1);
    EXPECT_EQ(s.partner[1], 0);
}

TEST(PositionScore, TheMarginCountsNeitherAsMissedNorAsSpurious) {
    const PositionScore s = score_positions({{2, 2}}, {{98, 98}}, 1, 100, 100, 16);
    EXPECT_EQ(s.missed, 0);
    EXPECT_EQ(s.spurious, 0);
}

}  // namespace
}  // namespace grainfield::tracking
