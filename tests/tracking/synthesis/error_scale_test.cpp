#include "tracking/synthesis/error_scale.h"

#include <cmath>

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
    double within = 0;
    for (const std::size_t i : inner) {
        const double stated = scale.height[classes[i]] * found.error[i].z;
        within += std::abs(off(i) - mean) < 2 * stated ? 1 : 0;
    }
    EXPECT_GE(within / static_cast<double>(inner.size()), 0.85);
    for (const auto& factors : {scale.plane, scale.height}) {
        for (const double factor : factors) {
            EXPECT_GE(factor, 1);
            EXPECT_LT(factor, 10);
        }
    }
}

}  // namespace
}  // namespace grainfield::tracking
