#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/layer_frames.h"
#include "tests/support/position_score.h"
#include "tracking/calibrate/edge_fit.h"
#include "tracking/locate.h"
#include "tracking/model/product_image.h"
#include "tracking/point_grid.h"
#include "tracking/score/position_bounds.h"

// The steps of CONTRIBUTING.md, "Add an image model", taken in one file: a new profile and a new
// rule for overlaps, used by detection, refinement, the error bars and the edge fit.
namespace grainfield::tracking {
namespace {

using testing::score_positions;

/// Step 1a. An opaque disc behind a Gaussian blur: P = erfc((r − D/2)/w)/2.
class GaussianEdge final : public ProfileShape {
 public:
    std::string_view name() const override { return "gaussian"; }
    double darkness(double r, double diameter, double edge_width) const override {
        return 0.5 * std::erfc((r - diameter / 2) / edge_width);
    }
    double reach_in_widths() const override { return 2.2; }  // erfc(2.2)/2 = 9e-4
};
const GaussianEdge kGaussian;

/// Step 1b. The darkest disc hides the others: T' = min_j t_j.
class DarkestDisc final : public OverlapRule {
 public:
    std::string_view name() const override { return "darkest"; }
    std::string_view title() const override { return "darkest disc"; }
    std::string_view condition() const override { return "if the darkest disc is seen"; }
    void add_to(const DiscBand& discs, Image& darkness) const override {
        Image least(darkness.width(), discs.last - discs.first, 1.0F);
        discs.each_pixel(0, [&](int x, int row, const DiscPixel& p) {
            least(x, row) = std::min(least(x, row), 1 - discs.profile.darkness(p.r));
        });
        for (int y = discs.first; y < discs.last; ++y) {
            for (int x = 0; x < darkness.width(); ++x) {
                darkness(x, y) += least(x, y - discs.first) - discs.sums.transmission(y)[x];
            }
        }
    }
};
const DarkestDisc kDarkest;

constexpr double kNoise = 0.02;

/// The model in double precision, with white noise.
Image rendered(const testing::LayerScene& scene, const DiscProfile& disc, bool is_darkest) {
    RandomStream random(11, "image model");
    Image image(scene.width, scene.height);
    PointGrid grid(scene.width, scene.height, disc.reach());
    for (const Vec2 p : scene.position) grid.add(p, 0);
    for (int y = 0; y < scene.height; ++y) {
        for (int x = 0; x < scene.width; ++x) {
            double t = 1;
            const Vec2 pixel{static_cast<double>(x), static_cast<double>(y)};
            grid.near(pixel, disc.reach(), [&](std::uint32_t, Vec2 p) {
                const double own = 1 - disc.darkness(norm(p - pixel));
                t = is_darkest ? std::min(t, own) : t * own;
            });
            image(x, y) = static_cast<float>(1 - t + kNoise * random.normal());
        }
    }
    return image;
}

double expected_error(const testing::LayerScene& scene, const DiscProfile& disc) {
    const auto bound = position_bounds(scene.position, disc, scene.width, scene.height, kNoise, 2);
    double squares = 0;
    for (const Vec2 b : bound) squares += 0.5 * squared_norm(b);
    return std::sqrt(squares / static_cast<double>(bound.size()));
}

Located located(const Image& image, const DiscModel& model) {
    return Locator(image.width(), image.height(), model, 2).locate(image, {}, {});
}

TEST(AddAnImageModel, ANewProfileIsFittedToItsNoise) {
    const DiscProfile disc{16, 1.7, &kGaussian};
    const auto scene = testing::hard_disc_liquid(480, 480, 16, 0.65, 3);
    const Image image = rendered(scene, disc, false);
    const Located found = located(image, disc);
    const auto s = score_positions(found.position, scene.position, 4, 480, 480, 16);
    EXPECT_EQ(s.missed + s.spurious, 0);
    EXPECT_NEAR(found.residual_rms, kNoise, 0.02 * kNoise);
    // Some 600 discs scatter by 2 %; 10 % are 5 σ.
    EXPECT_NEAR(s.rms / expected_error(scene, disc), 1, 0.1);
    // The error bars are those of this profile.
    double squares = 0;
    for (const Vec2 e : found.error) squares += 0.5 * squared_norm(kNoise * e);
    EXPECT_NEAR(
        std::sqrt(squares / static_cast<double>(found.error.size())) / expected_error(scene, disc),
        1, 0.05);
    // The tanh edge leaves more than the noise of this image.
    EXPECT_GT(located(image, DiscProfile{16, 1.7}).residual_rms, 1.1 * kNoise);
}

// π ∫ (∂P/∂r)² r dr with ∂P/∂r = exp(−((r − D/2)/w)²)/(w √π).
TEST(AddAnImageModel, WhatANewProfileKnowsOfAPositionIsSummedForIt) {
    const DiscProfile disc{16, 1.7, &kGaussian};
    const double closed = std::sqrt(std::numbers::pi / 2) * 8 / 1.7;
    EXPECT_NEAR(disc.information() / closed, 1, 1e-3);
}

TEST(AddAnImageModel, ItsSizeAndEdgeAreCalibrated) {
    const DiscProfile disc{16, 1.7, &kGaussian};
    const auto scene = testing::isolated_discs(480, 480, 16, 32, 1);
    const Image image = rendered(scene, disc, false);
    const EdgeFit fit = fit_exposed_edges(image, scene.position, {15.5, 1.4, &kGaussian});
    EXPECT_TRUE(fit.converged);
    EXPECT_EQ(fit.disc.shape, &kGaussian);
    EXPECT_NEAR(fit.disc.diameter, 16, 0.01);
    EXPECT_NEAR(fit.disc.edge_width, 1.7, 0.02);
}

TEST(AddAnImageModel, ANewRuleForOverlapsIsFittedToItsNoise) {
    const DiscProfile disc{16, 1.2};
    const auto scene = testing::hard_disc_liquid(480, 480, 15, 0.72, 5);
    const Image image = rendered(scene, disc, true);
    const Located darkest = located(image, {disc, kDarkest});
    const Located product = located(image, disc);
    const auto s = score_positions(darkest.position, scene.position, 4, 480, 480, 16);
    EXPECT_EQ(s.missed + s.spurious, 0);
    EXPECT_NEAR(darkest.residual_rms, kNoise, 0.05 * kNoise);
    EXPECT_GT(product.residual_rms, 1.1 * kNoise);
    EXPECT_LT(s.rms, 1.15 * expected_error(scene, disc));
    EXPECT_LT(s.rms, score_positions(product.position, scene.position, 4, 480, 480, 16).rms);
}

}  // namespace
}  // namespace grainfield::tracking
