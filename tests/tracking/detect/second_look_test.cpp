#include "tracking/detect/second_look.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

constexpr int kSize = 320;
constexpr double kNoise = 0.02;
constexpr DiscProfile kDisc{16, 1.2};
const RefinementOptions kRough{.tolerance = 0.03, .max_sweeps = 4};

Image darkness_of(const testing::LayerScene& scene, std::uint64_t seed) {
    Image image = testing::tanh_frame(scene, kDisc.diameter, kDisc.edge_width, kNoise, seed);
    for (float& v : image.pixels()) v = (200 - v) / 170;
    return image;
}

/// Two layers whose projections leave all but no hole.
testing::LayerScene closed_crystal() {
    testing::CrystalPatch patch;
    patch.radius = 0.25;
    patch.spacing = 0.72;
    patch.clearance = 1;
    return testing::crystal_in_liquid(kSize, kSize, 16, 0.65, patch, 3);
}

double nearest(const std::vector<Vec2>& points, Vec2 p) {
    double least = std::numeric_limits<double>::infinity();
    for (const Vec2 q : points) least = std::min(least, norm(q - p));
    return least;
}

struct Look {
    SecondLook summary;
    std::vector<Vec2> before, after;
    double misfit_before = 0, misfit_after = 0;
};

/// Looks again at what becomes of these discs on their own.
Look looked(const Image& darkness, const std::vector<Vec2>& discs, int threads = 2) {
    JointFit fit(darkness, kDisc, threads);
    fit.restart(darkness);
    fit.add_all(discs);
    fit.refine({.tolerance = 0.003, .max_sweeps = 150});
    DiscCorrelation correlation(darkness.width(), darkness.height(), kDisc,
                                DiscCorrelation::suitable_factor(kDisc));
    Look look;
    look.before = fit.positions();
    look.misfit_before = fit.residual_rms();
    look.summary =
        look_again(fit, correlation, 0.34 * kDisc.diameter, kNoise, 0.04, kRough, residual_of(fit));
    look.after = fit.positions();
    look.misfit_after = fit.residual_rms();
    return look;
}

std::vector<Vec2> without(std::vector<Vec2> discs, std::size_t j) {
    discs.erase(discs.begin() + static_cast<std::ptrdiff_t>(j));
    return discs;
}

TEST(SecondLook, WhereNothingIsUnusualNothingIsTried) {
    const auto scene = testing::hard_disc_liquid(kSize, kSize, 16, 0.7, 1);
    const Look look = looked(darkness_of(scene, 1), scene.position);
    EXPECT_EQ(look.summary.trials, 0);
    EXPECT_EQ(look.summary.steps, 0);
    EXPECT_EQ(look.after, look.before);
}

TEST(SecondLook, ASphereThatItsNeighboursCoverForIsFound) {
    const auto scene = closed_crystal();
    const Image darkness = darkness_of(scene, 2);
    int found = 0;
    int mended = 0;
    int tried = 0;
    for (std::size_t j = scene.crystal_begin + 20; j + 20 < scene.position.size(); j += 12) {
        const Look look = looked(darkness, without(scene.position, j));
        ++tried;
        if (look.summary.kept > 0) ++mended;
        if (nearest(look.after, scene.position[j]) < 4) ++found;
        EXPECT_LE(look.misfit_after, look.misfit_before) << j;
        EXPECT_NEAR(look.misfit_after, kNoise, 0.02 * kNoise) << j;
    }
    EXPECT_GE(tried, 8);
    // One of them at most leaves no trace that stands out of the noise.
    EXPECT_GE(found, tried - 1);
    EXPECT_GE(mended, tried - 1);
}

TEST(SecondLook, WhoDoesNotHelpLeavesAndItsNeighboursGoBack) {
    const auto scene = closed_crystal();
    Image darkness = darkness_of(scene, 5);
    // Scratches that no disc explains, across discs that can settle in more than one way.
    for (const int left : {130, 160, 190}) {
        for (int y = 120; y < 200; ++y) {
            for (int x = left; x < left + 2; ++x) darkness(x, y) += y % 4 < 2 ? 0.5F : -0.5F;
        }
    }
    const Look look = looked(darkness, scene.position);
    EXPECT_GT(look.summary.trials, 0);
    EXPECT_EQ(look.summary.kept, 0);
    ASSERT_EQ(look.after.size(), look.before.size());
    double farthest = 0;
    for (std::size_t j = 0; j < look.after.size(); ++j) {
        farthest = std::max(farthest, norm(look.after[j] - look.before[j]));
    }
    // Those farther away than neighbours have taken sweeps meanwhile; 0.29 if none went back.
    EXPECT_LT(farthest, 0.15);
}

TEST(SecondLook, TwoMissingNeighboursAreFound) {
    const auto scene = closed_crystal();
    const std::size_t j = scene.crystal_begin + 60;
    const Look look = looked(darkness_of(scene, 6), without(without(scene.position, j + 1), j));
    EXPECT_GE(look.summary.kept, 2);
    EXPECT_NEAR(look.misfit_after, kNoise, 0.02 * kNoise);
}

TEST(SecondLook, TheResultDoesNotDependOnTheNumberOfThreads) {
    const auto scene = closed_crystal();
    const Image darkness = darkness_of(scene, 4);
    std::vector<Vec2> discs;
    for (std::size_t j = 0; j < scene.position.size(); ++j) {
        if (j % 17 != 5) discs.push_back(scene.position[j]);
    }
    const Look one = looked(darkness, discs, 1);
    EXPECT_GT(one.summary.kept, 0);
    for (const int threads : {2, 5}) {
        const Look many = looked(darkness, discs, threads);
        EXPECT_EQ(many.after, one.after);
        EXPECT_EQ(many.summary.trials, one.summary.trials);
    }
}

TEST(SecondLook, AFitWithoutDiscsIsLeftAlone) {
    testing::LayerScene one{kSize, kSize, 16, {{100, 100}}, {Layer::unknown}, 1};
    const Look look = looked(darkness_of(one, 1), {});
    EXPECT_EQ(look.summary.trials, 0);
    EXPECT_TRUE(look.after.empty());
}

}  // namespace
}  // namespace grainfield::tracking
