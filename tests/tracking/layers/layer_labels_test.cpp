#include "tracking/layers/layer_labels.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/support/slit_spheres.h"

namespace grainfield::tracking {
namespace {

constexpr double kPixels = 16;

OverlapGraph graph_of(const testing::SlitScene& scene) {
    std::vector<Vec2> positions;
    for (const Vec2 p : scene.position) positions.push_back(kPixels * p);
    return {{kPixels, scene.height}, positions, {}};
}

LayerLabels labels_of(const OverlapGraph& graph) {
    return label_layers(graph, std::vector<char>(graph.size(), 1));
}

struct Verdict {
    std::int64_t labelled = 0, wrong = 0, out_of_bounds = 0;
};

/// Against the true heights, each cluster the right way up.
Verdict judged(const LayerLabels& labels, const testing::SlitScene& scene) {
    const double slack = scene.height - 1;
    std::vector<std::int64_t> right(static_cast<std::size_t>(labels.clusters), 0);
    std::vector<std::int64_t> size = right;
    const auto is_right = [&](std::size_t i) {
        return (scene.z[i] > slack / 2) == (labels.layer[i] == Layer::top);
    };
    Verdict verdict;
    for (std::size_t i = 0; i < scene.z.size(); ++i) {
        if (labels.cluster[i] < 0) {
            EXPECT_EQ(labels.layer[i], Layer::unknown);
            continue;
        }
        ++verdict.labelled;
        ++size[static_cast<std::size_t>(labels.cluster[i])];
        right[static_cast<std::size_t>(labels.cluster[i])] += is_right(i);
    }
    for (std::size_t c = 0; c < size.size(); ++c) {
        verdict.wrong += std::min(right[c], size[c] - right[c]);
    }
    for (std::size_t i = 0; i < scene.z.size(); ++i) {
        if (labels.cluster[i] < 0) continue;
        const auto c = static_cast<std::size_t>(labels.cluster[i]);
        const double z = 2 * right[c] >= size[c] ? scene.z[i] : slack - scene.z[i];
        verdict.out_of_bounds += z < labels.lowest[i] - 1e-6 || z > labels.highest[i] + 1e-6;
    }
    return verdict;
}

TEST(LayerLabels, OfACrystalAreAllKnownAndRight) {
    for (const double spacing : {0.72, 0.75, 0.81}) {
        const auto scene = testing::shaken_bilayer(40, 1.94, spacing, 0.02, 100, 1);
        const auto labels = labels_of(graph_of(scene));
        const Verdict verdict = judged(labels, scene);
        EXPECT_EQ(verdict.wrong, 0) << spacing;
        EXPECT_EQ(verdict.out_of_bounds, 0) << spacing;
        EXPECT_EQ(labels.contradictory, 0);
        EXPECT_GT(static_cast<double>(verdict.labelled),
                  0.99 * static_cast<double>(scene.z.size()));
        EXPECT_EQ(labels.clusters, 1);
    }
}

// φ = .919, disordered: many overlaps, few that force. What is named by odds of 100 to 1 may be
// wrong now and then.
TEST(LayerLabels, OfALiquidAreHardlyEverWrong) {
    for (const double height : {1.94, 1.84}) {
        const auto scene = testing::shaken_bilayer(60, height, 0.9243, 0.15, 600, 2);
        const auto labels = labels_of(graph_of(scene));
        const Verdict verdict = judged(labels, scene);
        const auto labelled = static_cast<double>(verdict.labelled);
        EXPECT_LT(static_cast<double>(verdict.wrong), 0.005 * labelled) << height;
        EXPECT_LE(verdict.out_of_bounds, verdict.wrong) << height;
        EXPECT_EQ(labels.contradictory, 0) << height;
        EXPECT_GT(labelled, 0.1 * static_cast<double>(scene.z.size())) << height;
    }
}

TEST(LayerLabels, AnOddRingOfCloseSpheresIsAContradiction) {
    // Five spheres at .86 a from their neighbours: each pair needs opposite layers.
    const double r = 0.86 / (2 * std::sin(M_PI / 5));
    testing::SlitScene ring{10, 1.94, {}, {}};
    for (int i = 0; i < 5; ++i) {
        ring.position.push_back(
            {5 + r * std::cos(2 * M_PI * i / 5), 5 + r * std::sin(2 * M_PI * i / 5)});
    }
    const auto labels = labels_of(graph_of(ring));
    EXPECT_EQ(labels.contradictory, 5);
    EXPECT_EQ(labels.clusters, 0);
    for (const Layer layer : labels.layer) EXPECT_EQ(layer, Layer::unknown);
}

TEST(LayerLabels, AMisplacedSphereLeavesTheRestOfTheCrystalItsLayers) {
    const auto scene = testing::shaken_bilayer(30, 1.94, 0.8, 0.02, 60, 1);
    testing::SlitScene wrong = scene;
    int moved = 0;
    for (std::size_t i = 0; i < wrong.position.size(); i += 97, ++moved) {
        wrong.position[i] += Vec2{0.25, 0.2};
    }
    const auto labels = labels_of(graph_of(wrong));
    const Verdict verdict = judged(labels, scene);
    EXPECT_GT(labels.contradictory, 0);
    // A misplaced sphere costs some twenty others their labels, and none gets a wrong one.
    EXPECT_LT(labels.contradictory, 25 * moved);
    EXPECT_LE(verdict.wrong, 1);
    EXPECT_GT(static_cast<double>(verdict.labelled), 0.7 * static_cast<double>(scene.z.size()));
}

TEST(LayerLabels, NothingIsSaidOfSpheresThatDoNotOverlapEnough) {
    const testing::SlitScene apart{10, 1.94, {{2, 2}, {2.95, 2}, {6, 6}}, {}};
    const auto labels = labels_of(graph_of(apart));
    for (const Layer layer : labels.layer) EXPECT_EQ(layer, Layer::unknown);
}

/// A row of spheres, each between two others of the other side, `at` apart.
void add_row(std::vector<OverlapPair>& pairs, std::uint32_t first, std::uint32_t count) {
    for (std::uint32_t i = first; i + 1 < first + count; ++i)
        pairs.push_back({i, i + 1, 0.6, 0.6, 0.8, 0});
}

TEST(LayerLabels, OfGroupsThatOverlapAndCouldBeTurnedEitherWayTheLargestIsNamed) {
    // Rows of 5, 3 and 4 spheres. The second touches both others with an overlap that tells little.
    std::vector<OverlapPair> pairs;
    add_row(pairs, 0, 5);
    add_row(pairs, 5, 3);
    add_row(pairs, 8, 4);
    pairs.push_back({4, 5, 0, 0, 0.99, 0});
    pairs.push_back({7, 8, 0, 0, 0.99, 0});
    const LayerLabels labels = labels_of(OverlapGraph(0.94, 12, pairs));
    EXPECT_EQ(labels.clusters, 2);
    for (std::size_t i = 0; i < 12; ++i) {
        EXPECT_EQ(labels.layer[i] == Layer::unknown, i >= 5 && i < 8) << i;
    }
}

TEST(LayerLabels, OverlapsThatTellLittleJoinGroupsTogether) {
    // At .93 a opposite sides are likelier by 24 to 1: two such overlaps are enough.
    std::vector<OverlapPair> pairs;
    add_row(pairs, 0, 4);
    add_row(pairs, 4, 3);
    pairs.push_back({0, 4, 0, 0, 0.93, 0});
    EXPECT_EQ(std::ranges::count(labels_of(OverlapGraph(0.94, 7, pairs)).layer, Layer::unknown), 3);
    pairs.push_back({1, 5, 0, 0, 0.93, 0});
    const LayerLabels labels = labels_of(OverlapGraph(0.94, 7, pairs));
    EXPECT_EQ(labels.clusters, 1);
    EXPECT_NE(labels.layer[0], labels.layer[4]);
    EXPECT_NE(labels.layer[1], labels.layer[5]);
}

TEST(LayerLabels, ASphereLeftOutSaysNothing) {
    const testing::SlitScene pair{10, 1.94, {{2, 2}, {2.7, 2}}, {}};
    const OverlapGraph graph = graph_of(pair);
    EXPECT_NE(label_layers(graph, {1, 1}).layer[0], Layer::unknown);
    EXPECT_EQ(label_layers(graph, {1, 0}).layer[0], Layer::unknown);
    EXPECT_THROW(label_layers(graph, {1}), InputError);
}

TEST(LayerLabels, SidesAreKeptByTheMajorityOfThoseKnownBefore) {
    const auto scene = testing::shaken_bilayer(12, 1.94, 0.8, 0.02, 20, 1);
    const LayerLabels labels = labels_of(graph_of(scene));
    LayerLabels same = labels;
    keep_sides(same, labels.layer);
    EXPECT_EQ(same.layer, labels.layer);
    std::vector<Layer> turned(labels.layer.size(), Layer::unknown);
    for (std::size_t i = 0; i < turned.size(); i += 3) {
        turned[i] = labels.layer[i] == Layer::top ? Layer::bottom : Layer::top;
    }
    LayerLabels other = labels;
    keep_sides(other, turned);
    for (std::size_t i = 0; i < turned.size(); ++i) {
        EXPECT_NE(other.layer[i], labels.layer[i]);
        EXPECT_NEAR(other.lowest[i], 0.94 - labels.highest[i], 1e-12);
    }
}

}  // namespace
}  // namespace grainfield::tracking
