#include "tracking/synthesis/error_scale.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

using testing::displaced;
using testing::rendered_layer;
using testing::RenderedLayer;

constexpr double kScale = 12;  // [px/a]

BrightnessStart start_of(const RenderedLayer& layer) {
    BrightnessStart start{.spheres = displaced(layer, 0.02, 0, 5),
                          .are_heights_known = false,
                          .optics = layer.optics,
                          .are_optics_known = true};
    for (Point3& p : start.spheres) p.z = static_cast<float>(0.5 * (layer.height - 1));
    return start;
}

TEST(ErrorScale, SpheresOverlapThatAreNearInThePictureAtAnyHeight) {
    const std::vector<Point3> spheres = {{1, 1, 0}, {1.8F, 1, 0.9F}, {3, 1, 0}};
    EXPECT_EQ(overlap_classes(spheres), (std::vector<std::size_t>{0, 0, 1}));
}

/// |error| / stated error of Gaussian errors that are stated `small` times too small.
std::vector<double> understated(double small, std::size_t count, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, small);
    std::vector<double> ratios(count);
    std::ranges::generate(ratios, [&] { return std::abs(normal(random)); });
    return ratios;
}

TEST(ErrorFactors, AreWhatErrorsAreStatedTooSmallBy) {
    const std::array<double, 2> factors =
        error_factors({understated(2.5, 20000, 1), understated(1.6, 20000, 2)}, 1);
    EXPECT_NEAR(factors[0], 2.5, 0.05);
    EXPECT_NEAR(factors[1], 1.6, 0.03);
}

TEST(ErrorFactors, MakeNoErrorSmaller) {
    EXPECT_EQ(error_factors({understated(0.4, 500, 1), understated(0.9, 500, 2)}, 1),
              (std::array<double, 2>{1, 1}));
}

TEST(ErrorFactors, CoverLongTailsToTwiceTheStatedError) {
    // One in ten is off by eight times the stated error: 95.4 % lie within 2 · 4.
    std::vector<double> tailed(1000, 0.5);
    std::fill_n(tailed.begin(), 100, 8.0);
    EXPECT_EQ(error_factors({tailed, tailed}, 1), (std::array<double, 2>{4, 4}));
}

TEST(ErrorFactors, AreSharedWhereAClassHasFewSpheres) {
    const std::vector<double> many = understated(3, 2000, 1);
    const std::vector<double> few(2 * ErrorScale::kLeast - 1, 0.1);
    const std::array<double, 2> shared = error_factors({few, many}, 2);
    EXPECT_EQ(shared[0], shared[1]);
    EXPECT_NEAR(shared[0], 3, 0.2);
    const std::vector<double> enough(2 * ErrorScale::kLeast, 0.1);
    EXPECT_EQ(error_factors({enough, many}, 2)[0], 1);
}

TEST(ErrorScale, IsNotLearnedFromFewSpheres) {
    const RenderedLayer layer = rendered_layer(6, kScale, 0.02, 8);
    const BrightnessStart start = start_of(layer);
    const BrightnessSynthesis found =
        synthesise_brightness(layer.brightness, layer.ceiling, kScale, start, layer.height, 0, 2);
    EXPECT_EQ(learn_error_scale(layer.brightness, layer.ceiling, kScale, start, found, layer.height,
                                0, 2),
              ErrorScale{});
}

// Of 95.4 %, 85 % at least: heights err together over some diameters, so of 50 spheres about ten
// are independent, and two of them may lie beyond.
TEST(ErrorScale, PutsTheErrorsOfHeightsWithinTwiceTheStatedOnes) {
    const RenderedLayer layer = rendered_layer(12, kScale, 0.02, 31);
    const BrightnessStart start = start_of(layer);
    const BrightnessSynthesis found =
        synthesise_brightness(layer.brightness, layer.ceiling, kScale, start, layer.height, 0, 2);
    const ErrorScale scale = learn_error_scale(layer.brightness, layer.ceiling, kScale, start,
                                               found, layer.height, 0, 2);
    ASSERT_GE(scale.spheres, 60);
    const std::vector<std::size_t> classes = overlap_classes(found.spheres);
    std::vector<std::size_t> inner;
    double mean = 0;
    const auto off = [&](std::size_t i) {
        return static_cast<double>(found.spheres[i].z - layer.spheres[i].z);
    };
    for (std::size_t i = 0; i < found.spheres.size(); ++i) {
        if (!layer.is_inner(found.spheres[i], 2) || found.is_doubtful[i] != 0) continue;
        inner.push_back(i);
        mean += off(i);
    }
    ASSERT_GT(inner.size(), 25U);
    mean /= static_cast<double>(inner.size());
    const auto within = [&](const std::array<double, 2>& factors) {
        const auto covered = std::ranges::count_if(inner, [&](std::size_t i) {
            return std::abs(off(i) - mean) < 2 * factors[classes[i]] * found.error[i].z;
        });
        return static_cast<double>(covered) / static_cast<double>(inner.size());
    };
    EXPECT_GE(within(scale.height), 0.85);
    EXPECT_LT(within({1, 1}), 0.85) << "errors of the fit alone would do";
    for (const auto& factors : {scale.plane, scale.height}) {
        for (const double factor : factors) {
            EXPECT_GE(factor, 1);
            EXPECT_LT(factor, 10);
        }
    }
}

}  // namespace
}  // namespace grainfield::tracking
