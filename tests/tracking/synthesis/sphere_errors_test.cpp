#include "tracking/synthesis/sphere_errors.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/pull.h"
#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

using testing::Pull;
using testing::rendered_layer;
using testing::RenderedLayer;

Image white_noise(int width, int height) {
    RandomStream random(9, "white");
    Image noise(width, height);
    for (float& v : noise.pixels()) v = static_cast<float>(random.normal());
    return noise;
}

TEST(SphereErrors, WhiteNoiseIsIndependentFromPixelToPixel) {
    EXPECT_NEAR(correlated_pixels(white_noise(300, 300)), 1, 0.05);
}

TEST(SphereErrors, ABlurCorrelatesAsManyPixelsAsItSpreadsOver) {
    // The mean of 3 × 3: its correlation sums to 9.
    const Image sharp = white_noise(302, 302);
    Image spread(300, 300);
    for (int y = 0; y < 300; ++y) {
        for (int x = 0; x < 300; ++x) {
            for (int k = 0; k < 9; ++k) spread(x, y) += sharp(x + k % 3, y + k / 3);
        }
    }
    EXPECT_NEAR(correlated_pixels(spread), 9, 0.5);
}

TEST(SphereErrors, TheJointSolutionSolvesWhatSpheresShare) {
    const RenderedLayer layer = rendered_layer(7, 12, 0.02, 20);
    SynthesisFit fit(layer.brightness, layer.ceiling, 12, 2);
    fit.start(layer.spheres, layer.optics);
    const SynthesisFit::Information info = fit.information();
    const auto x = joint_solution(info, info.gradient, 2);
    double wrong = 0;
    double all = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
        for (std::size_t p = 0; p < 3; ++p) {
            double left = info.gradient[i][p];
            for (std::size_t q = 0; q < 3; ++q) left -= info.own[i][3 * p + q] * x[i][q];
            for (const SynthesisFit::Block& block : info.pair[i]) {
                for (std::size_t q = 0; q < 3; ++q) {
                    left -= static_cast<double>(block.value[3 * p + q]) *
                            x[static_cast<std::size_t>(block.other)][q];
                }
            }
            wrong += left * left;
            all += info.gradient[i][p] * info.gradient[i][p];
        }
    }
    EXPECT_LT(std::sqrt(wrong / all), 0.01);
    // Without what they share it is another.
    EXPECT_GT(std::abs(x[0][0] - info.gradient[0][0] / info.own[0][0]), 0);
}

// From the truth, where the rendering is linear in the step. The step itself leaves misfits of the
// rays' grid that are correlated, so that κ widens errors that white noise alone would not. σ is
// the larger of the residual about a sphere and its median, a tenth above the noise.
TEST(SphereErrors, PullsOfOneStepOnFramesOfTheModelAreOneBeforeTheyAreWidened) {
    constexpr double kScale = 12;  // [px/a]
    Pull plane;
    Pull height;
    Pull widened;
    for (const std::uint64_t seed : {21U, 22U, 23U, 24U, 25U, 26U}) {
        const RenderedLayer layer = rendered_layer(11, kScale, 0.02, seed);
        SynthesisFit fit(layer.brightness, layer.ceiling, kScale, 2);
        fit.start(layer.spheres, layer.optics);
        const SynthesisLimits limits{.height = layer.height, .most_rounds = 1};
        fit.refine(limits);
        const std::vector<SphereError> errors = sphere_errors(fit, 2);
        const double wide = std::sqrt(correlated_pixels(fit.residual()));
        for (std::size_t i = 0; i < errors.size(); ++i) {
            const Point3& p = layer.spheres[i];
            const Point3& q = fit.spheres()[i];
            // At a plate the cell cuts the error off.
            const bool is_free = p.z > 0.06F && p.z < static_cast<float>(layer.height - 1) - 0.06F;
            if (!layer.is_inner(p, 1) || !is_free) continue;
            plane.add(wide * static_cast<double>(q.x - p.x) / errors[i].x);
            plane.add(wide * static_cast<double>(q.y - p.y) / errors[i].y);
            height.add(wide * static_cast<double>(q.z - p.z) / errors[i].z);
            widened.add(static_cast<double>(q.x - p.x) / errors[i].x);
            EXPECT_NEAR(errors[i].residual, 0.02, 0.008);
        }
    }
    ASSERT_GT(height.count, 150);
    for (const Pull& pull : {plane, height}) {
        EXPECT_NEAR(pull.mean(), 0, 5 / std::sqrt(pull.count));
        EXPECT_GT(pull.width(), 0.8);
        EXPECT_LT(pull.width(), 1.15);
    }
    EXPECT_LT(widened.width(), plane.width());
}

/// The factor after three rounds from the truth, with a diameter that is too large by
/// a factor.
double factor_with(const RenderedLayer& layer, double enlarged) {
    SynthesisFit fit(layer.brightness, layer.ceiling, layer.scale * enlarged, 2);
    std::vector<Point3> spheres = layer.spheres;
    for (Point3& p : spheres) {
        p.x /= static_cast<float>(enlarged);
        p.y /= static_cast<float>(enlarged);
    }
    fit.start(std::move(spheres), layer.optics);
    fit.refine({.height = layer.height, .most_rounds = 3});
    return overlap_factor(fit, std::vector<char>(layer.spheres.size(), 0), 2);
}

TEST(SphereErrors, OverlapsOfHardSpheresShowADiameterThatIsTooLarge) {
    const RenderedLayer layer = rendered_layer(22, 12, 0.01, 31);
    const double right = factor_with(layer, 1);
    const double enlarged = factor_with(layer, 1.04);
    RecordProperty("right", std::to_string(right));
    RecordProperty("enlarged", std::to_string(enlarged));
    EXPECT_LT(right, 1.6);
    EXPECT_GT(enlarged, 1.5 * right);
}

TEST(SphereErrors, FewOverlapsSayNothing) {
    const RenderedLayer layer = rendered_layer(6, 12, 0.01, 32);
    EXPECT_EQ(factor_with(layer, 1.04), 1);
}

}  // namespace
}  // namespace grainfield::tracking
