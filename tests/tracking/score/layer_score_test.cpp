#include "tracking/score/layer_score.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

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
    EXPECT_DOUBLE_EQ(score.accuracy_up_to_flip(), 1.0 / 2);  // of the two that are tested
}

TEST(LayerScore, ASphereAloneInItsClusterProvesNothingUpToAFlip) {
    const std::vector<Vec2> truth{{0, 0}, {50, 0}, {100, 0}, {105, 0}};
    LayerScore score;
    score.add(truth, {top, top, top, bottom}, {top, bottom, top, top}, {0, 1, 2, 3}, 8);
    EXPECT_EQ(score.labelled, 4);
    EXPECT_DOUBLE_EQ(score.accuracy(), 1.0 / 2);
    EXPECT_EQ(score.tested, 1);  // the pair
    EXPECT_EQ(score.accuracy_up_to_flip(), 0);
    LayerScore alone;
    alone.add({{0, 0}}, {top}, {top}, {0}, 8);
    EXPECT_EQ(alone.accuracy(), 1);
    EXPECT_TRUE(std::isnan(alone.accuracy_up_to_flip()));
}

// Labels that know nothing score what chance gives: 1/2 of pairs (standard error 0.01).
TEST(LayerScore, LabelsDrawnByLotAreRightInHalfOfThePairs) {
    RandomStream random(1, "layer score");
    std::vector<Vec2> truth;
    std::vector<Layer> layers, labels;
    std::vector<int> partner;
    for (int i = 0; i < 5000; ++i) {
        truth.push_back({50.0 * (i / 2) + 5.0 * (i % 2), 0});
        layers.push_back(i % 2 == 0 ? top : bottom);
        labels.push_back(random.uniform() < 0.5 ? top : bottom);
        partner.push_back(i);
    }
    LayerScore score;
    score.add(truth, layers, labels, partner, 8);
    EXPECT_EQ(score.tested, 2500);
    EXPECT_NEAR(score.accuracy_up_to_flip(), 0.5, 0.04);
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
