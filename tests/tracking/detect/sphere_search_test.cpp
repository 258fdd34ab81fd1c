#include "tracking/detect/sphere_search.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"
#include "tests/support/position_score.h"
#include "tracking/synthesis/bias_correction.h"

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

/// What is left of doubtful discs, that explain a fifth of an isolated one.
struct Doubtful {
    std::ptrdiff_t left = 0;
    bool are_false = false;
    double evidence = 0;
};

/// `tight` doubtful discs stand beside others, 0.9 a away, where a cell of 1.3 a has room from
/// 0.954 a on. `clear` ones stand alone. All are where positions are corrected, 1.2 a inside.
/// Where others explain 0.7 the model fits badly.
Doubtful doubtful_left(int tight, int clear, DetectionOptions options,
                       const BiasCorrection* correction, double others = 0.7) {
    constexpr double kA = 18;
    struct Spot {
        Vec2 place;
        double share;
    };
    std::vector<Spot> spots;
    std::vector<Vec2> doubtful;
    for (const Vec2 place : testing::isolated_discs(kSize, kSize, 16, 40, 1).position) {
        const bool is_inside = std::min({place.x, place.y, kSize - place.x, kSize - place.y}) > 30;
        const auto number = static_cast<int>(doubtful.size());
        const bool is_tight = is_inside && number < tight;
        const bool is_clear = is_inside && !is_tight && number < tight + clear;
        spots.push_back({place, is_clear ? 0.2 : others});
        if (is_tight) spots.push_back({place + Vec2{0.9 * kA, 0}, 0.2});
        if (is_tight || is_clear) doubtful.push_back(spots.back().place);
    }
    Image darkness(kSize, kSize);
    for (int y = 0; y < kSize; ++y) {
        for (int x = 0; x < kSize; ++x) {
            double bright = 1;
            for (const Spot& spot : spots) {
                const Vec2 from = Vec2{static_cast<double>(x), static_cast<double>(y)} - spot.place;
                if (norm(from) > kDisc.reach()) continue;
                // Of a disc with darkness b the model, with darkness 1, explains 2 b - 1.
                bright *= 1 - (1 + spot.share) / 2 * kDisc.darkness(norm(from));
            }
            darkness(x, y) = static_cast<float>(1 - bright);
        }
    }
    options.sphere_diameter = kA;
    options.cell_height = 1.3;
    JointFit fit(darkness, kDisc, 2);
    DiscCorrelation correlation(kSize, kSize, kDisc, DiscCorrelation::suitable_factor(kDisc));
    SphereSearch search(fit, correlation, options, correction);
    fit.restart(darkness);
    std::vector<Vec2> places;
    for (const Spot& spot : spots) places.push_back(spot.place);
    fit.add_all(places);
    search.finish(kRough, Drawing::exactly);
    const auto is_left = [&](Vec2 place) {
        return std::ranges::any_of(fit.positions(), [&](Vec2 p) { return norm(p - place) < 2; });
    };
    return {std::ranges::count_if(doubtful, is_left), search.summary().doubtful_are_false,
            search.summary().evidence};
}

/// Of a film whose positions are known to be right.
BiasCorrection no_bias() {
    BiasCorrection correction;
    correction.diameter = 18;
    correction.weights.assign(BiasTerms::kCount, 0.0);
    return correction;
}

TEST(SphereSearch, DoubtfulSpheresAreFalseWhereMostHardlyHaveRoom) {
    const BiasCorrection correction = no_bias();
    const Doubtful crystal = doubtful_left(10, 4, {}, &correction);
    EXPECT_EQ(crystal.left, 0);
    EXPECT_TRUE(crystal.are_false);
    const Doubtful liquid = doubtful_left(10, 5, {}, &correction);
    EXPECT_EQ(liquid.left, 15) << "no more than two lack it for one that has it";
    EXPECT_FALSE(liquid.are_false);
    EXPECT_EQ(doubtful_left(4, 0, {}, &correction).left, 4) << "too few to tell";
    EXPECT_EQ(doubtful_left(5, 0, {}, &correction).left, 0);
    EXPECT_EQ(doubtful_left(10, 0, {}, nullptr).left, 10) << "how positions err is not known";
    DetectionOptions asked;
    asked.evidence = 0.05;
    EXPECT_EQ(doubtful_left(10, 0, asked, &correction).left, 10);
}

TEST(SphereSearch, DoubtfulSpheresAreFalseAlsoWhereTheModelFits) {
    const BiasCorrection correction = no_bias();
    constexpr double kWell = 1;
    EXPECT_EQ(doubtful_left(10, 4, {}, &correction, kWell).left, 0);
    const Doubtful liquid = doubtful_left(10, 5, {}, &correction, kWell);
    EXPECT_EQ(liquid.left, 15);
    EXPECT_LT(liquid.evidence, 0.08) << "no single one is asked for room";
}

TEST(SphereSearch, DoubtfulSpheresAreFalseWhereTheFrameBeforeShowedIt) {
    const BiasCorrection correction = no_bias();
    DetectionOptions next;
    next.doubtful_are_false = true;
    const Doubtful crystal = doubtful_left(4, 2, next, &correction);
    EXPECT_EQ(crystal.left, 0);
    EXPECT_TRUE(crystal.are_false);
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
