#include "tracking/score/layer_score.h"

#include <cmath>

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

constexpr Layer top = Layer::top;
constexpr Layer bottom = Layer::bottom;
constexpr Layer unknown = Layer::unknown;

TEST(LayerScore, ExchangedLayersOfAClusterAreWrongButRightUpToAFlip) {
    // Two clusters of two overlapping spheres: the first named right, the second exchanged.
    const std::vector<Vec2> truth{{0, 0}, {5, 0}, {50, 0}, {55, 0}};
    LayerScore score;
    score.add(truth, {top, bottom, top, bottom}, {bottom, top, top, bottom}, {2, 3, 0, 1}, 8);
    EXPECT_EQ(score.matched, 4);
    EXPECT_EQ(score.labelled, 4);
    EXPECT_EQ(score.accuracy(), 0.5);
    EXPECT_EQ(score.accuracy_up_to_flip(), 1);
}

TEST(LayerScore, AMistakeInsideAClusterStaysOne) {
    const std::vector<Vec2> truth{{0, 0}, {5, 0}, {10, 0}};
    LayerScore score;
    score.add(truth, {top, bottom, top}, {bottom, top, top}, {0, 1, 2}, 8);
    EXPECT_DOUBLE_EQ(score.accuracy(), 1.0 / 3);
    EXPECT_DOUBLE_EQ(score.accuracy_up_to_flip(), 2.0 / 3);
}

TEST(LayerScore, MissedUnknownAndUnlabelledParticlesDoNotCount) {
    const std::vector<Vec2> truth{{0, 0}, {5, 0}, {10, 0}};
    LayerScore score;
    score.add(truth, {top, unknown, top}, {unknown, bottom}, {0, 1, -1}, 8);
    EXPECT_EQ(score.matched, 1);
    EXPECT_EQ(score.labelled, 0);
    EXPECT_TRUE(std::isnan(score.accuracy()));
    score.add(truth, {}, {}, {0, 1, -1}, 8);
    score.add(truth, {top, top, top}, {}, {0, 1, -1}, 8);
    EXPECT_EQ(score.matched, 3);
    EXPECT_EQ(score.labelled, 0);
}

}  // namespace
}  // namespace grainfield::tracking
