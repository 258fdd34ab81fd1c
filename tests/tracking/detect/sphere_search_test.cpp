#include "tracking/detect/sphere_search.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"
#include "tests/support/position_score.h"

namespace grainfield::tracking {
namespace {

constexpr int kSize = 240;
constexpr double kNoise = 0.02;
constexpr DiscProfile kDisc{16, 1.2};
const RefinementOptions kRough{.tolerance = 0.03, .max_sweeps = 4};

Image darkness_of(const testing::LayerScene& scene) {
    Image image = testing::tanh_frame(scene, kDisc.diameter, kDisc.edge_width, kNoise, 1);
    for (float& v : image.pixels()) v = (200 - v) / 170;
    return image;
}

testing::LayerScene liquid() {
    return testing::hard_disc_liquid(kSize, kSize, 16, 0.6, 1);
}

/// A search of one image.
struct Case {
    explicit Case(const testing::LayerScene& truth, const DetectionOptions& options = {})
        : scene(truth),
          darkness(darkness_of(truth)),
          fit(darkness, kDisc, 2),
          correlation(kSize, kSize, kDisc, DiscCorrelation::suitable_factor(kDisc)),
          search(fit, correlation, options) {
        fit.restart(darkness);
    }

    testing::PositionScore score() const {
        return testing::score_positions(fit.positions(), scene.position, 4, kSize, kSize, 16);
    }

    testing::LayerScene scene;
    Image darkness;
    JointFit fit;
    DiscCorrelation correlation;
    SphereSearch search;
};

TEST(SphereSearch, FromItsSeedsFindsEverySphereOfALiquid) {
    Case c(liquid());
    c.search.seed();
    EXPECT_GT(c.score().recall(), 0.9);
    c.search.run(kRough);
    const testing::PositionScore score = c.score();
    EXPECT_EQ(score.missed, 0);
    EXPECT_EQ(score.spurious, 0);
    EXPECT_TRUE(c.search.summary().settled_detection);
    // The noise that was put in, within what 58,000 pixels and the rounding to 8 bits leave.
    EXPECT_NEAR(c.search.summary().noise, std::hypot(kNoise, 1 / (170 * std::sqrt(12.0))), 5e-4);
    EXPECT_EQ(c.search.summary().evidence, 0.04) << "the model is exact";
}

TEST(SphereSearch, WithoutSeedsFindsTheSpheresInTheResidual) {
    Case c(liquid());
    c.search.run(kRough);
    EXPECT_EQ(c.score().missed, 0);
    EXPECT_EQ(c.score().spurious, 0);
    EXPECT_GE(c.search.summary().added,
              static_cast<std::int64_t>(c.scene.position.size()) * 9 / 10);
}

TEST(SphereSearch, ADiscWhereNothingIsGoesAndAMissingSphereComes) {
    const testing::LayerScene scene = testing::isolated_discs(kSize, kSize, 16, 40, 1);
    std::vector<Vec2> start = scene.position;
    start.erase(start.begin() + 14);
    start.push_back(0.5 * (scene.position[7] + scene.position[14]));
    Case c(scene);
    c.fit.add_all(start);
    c.search.run(kRough);
    EXPECT_EQ(c.score().missed, 0);
    EXPECT_EQ(c.score().spurious, 0);
    EXPECT_GE(c.search.summary().removed, 1);
    EXPECT_GE(c.search.summary().added, 1);
}

TEST(SphereSearch, OneDiscBetweenTwoSpheresIsSplit) {
    testing::LayerScene pair = testing::isolated_discs(kSize, kSize, 16, 300, 1);
    pair.position = {{100, 120}, {113, 120}};
    Case c(pair);
    c.fit.add({106.5, 120});
    c.search.run(kRough);
    EXPECT_EQ(c.score().missed, 0);
    EXPECT_EQ(c.score().spurious, 0);
}

TEST(SphereSearch, OfTwoDiscsOnOneSphereOneGoes) {
    testing::LayerScene one = testing::isolated_discs(kSize, kSize, 16, 300, 1);
    one.position = {{100, 120}};
    Case c(one);
    c.fit.add({99, 120});
    c.fit.add({101.5, 120});
    c.search.run(kRough);
    c.search.finish(kRough, Drawing::exactly);
    EXPECT_EQ(c.fit.positions().size(), 1U);
    EXPECT_NEAR(c.fit.positions()[0].x, 100, 0.1);
}

/// What stays of three discs in a row, 0.41 a apart: the one in the middle explains little. The
/// edges of the image are `edge` wide, those of the model 1.2 px.
std::size_t discs_of_a_row(double edge, const DetectionOptions& options) {
    testing::LayerScene three = testing::isolated_discs(kSize, kSize, 16, 300, 1);
    three.position = {{100, 120}, {107.4, 120}, {114.8, 120}};
    Image darkness = testing::tanh_frame(three, kDisc.diameter, edge, kNoise, 1);
    for (float& v : darkness.pixels()) v = (200 - v) / 170;
    JointFit fit(darkness, kDisc, 2);
    DiscCorrelation correlation(kSize, kSize, kDisc, DiscCorrelation::suitable_factor(kDisc));
    SphereSearch search(fit, correlation, options);
    fit.restart(darkness);
    fit.add_all(three.position);
    search.finish(kRough, Drawing::exactly);
    return fit.positions().size();
}

TEST(SphereSearch, SpheresThatExplainLittleNeedRoomWhereTheModelFitsBadly) {
    constexpr double kBlurred = 4;
    DetectionOptions options;
    options.sphere_diameter = 18;
    EXPECT_EQ(discs_of_a_row(kBlurred, options), 2U);
    EXPECT_EQ(discs_of_a_row(kDisc.edge_width, options), 3U) << "the model fits";
    options.cell_height = 3;
    EXPECT_EQ(discs_of_a_row(kBlurred, options), 3U);
}

/// What stays of 36 discs far from one another: some explain a tenth of an isolated one, some a
/// fifth, and the others 0.7, so that the model fits badly.
std::size_t discs_of_shares(int tenths, int fifths, const DetectionOptions& options) {
    const testing::LayerScene scene = testing::isolated_discs(kSize, kSize, 16, 40, 1);
    Image darkness(kSize, kSize);
    std::ranges::fill(darkness.pixels(), 0.0F);
    for (std::size_t j = 0; j < scene.position.size(); ++j) {
        const auto number = static_cast<int>(j);
        // Of a disc with darkness b the model, with darkness 1, explains 2 b - 1.
        const double share = number < tenths ? 0.1 : number < tenths + fifths ? 0.2 : 0.7;
        for (int y = 0; y < kSize; ++y) {
            for (int x = 0; x < kSize; ++x) {
                const double r =
                    norm(Vec2{static_cast<double>(x), static_cast<double>(y)} - scene.position[j]);
                if (r > kDisc.reach()) continue;
                darkness(x, y) = static_cast<float>((1 + share) / 2 * kDisc.darkness(r));
            }
        }
    }
    JointFit fit(darkness, kDisc, 2);
    DiscCorrelation correlation(kSize, kSize, kDisc, DiscCorrelation::suitable_factor(kDisc));
    SphereSearch search(fit, correlation, options);
    fit.restart(darkness);
    fit.add_all(scene.position);
    search.finish(kRough, Drawing::exactly);
    return fit.positions().size();
}

TEST(SphereSearch, ThoseThatExplainLittleAreFalseWhereTheyAreManyBesideThoseThatExplainMore) {
    DetectionOptions options;
    EXPECT_EQ(discs_of_shares(10, 0, options), 26U) << "a is not known, 0.15 is asked for";
    options.sphere_diameter = 18;
    EXPECT_EQ(discs_of_shares(10, 0, options), 26U);
    EXPECT_EQ(discs_of_shares(10, 16, options), 26U);
    EXPECT_EQ(discs_of_shares(5, 24, options), 36U) << "as of overlaps in a thick liquid";
    EXPECT_EQ(discs_of_shares(4, 0, options), 36U) << "too few to tell";
    options.weak_are_false = true;
    EXPECT_EQ(discs_of_shares(4, 0, options), 32U) << "so it was in the frame before";
    options.weak_are_false = false;
    options.evidence = 0.05;
    EXPECT_EQ(discs_of_shares(10, 0, options), 36U) << "as asked for";
}

TEST(SphereSearch, ForMostSpheresTakesOnePass) {
    DetectionOptions options;
    options.goal = SearchGoal::most_spheres;
    Case c(liquid(), options);
    c.search.seed();
    c.search.run(kRough);
    EXPECT_EQ(c.search.summary().passes, 1);
    EXPECT_GT(c.score().recall(), 0.95);
}

TEST(SphereSearch, OfNoiseFindsNothing) {
    testing::LayerScene empty = liquid();
    empty.position.clear();
    Case c(empty);
    c.search.seed();
    c.search.run(kRough);
    EXPECT_TRUE(c.fit.positions().empty());
    EXPECT_TRUE(c.search.summary().settled_detection);
}

}  // namespace
}  // namespace grainfield::tracking
