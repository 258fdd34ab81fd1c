#include "tracking/synthesis/optics_fit.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/image_part.h"
#include "tests/support/pull.h"
#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

using testing::rendered_layer;
using testing::RenderedLayer;

constexpr double kScale = 12;  // [px/a]

/// Heights within 5 a of the middle are wrong, as in a crystal that was not understood.
std::vector<Point3> misunderstood(const RenderedLayer& layer) {
    std::vector<Point3> spheres = layer.spheres;
    const double middle = 0.5 * layer.brightness.width() / kScale;
    for (Point3& p : spheres) {
        const double x = static_cast<double>(p.x) - middle;
        const double y = static_cast<double>(p.y) - middle;
        if (std::hypot(x, y) < 5) p.z = static_cast<float>(layer.height - 1) - p.z;
    }
    return spheres;
}

TEST(OpticsFit, NineSquaresAreNearerToTheTruthThanAMiddleThatIsMisunderstood) {
    const RenderedLayer layer = rendered_layer(27, kScale, 0.01, 18);
    const std::vector<Point3> spheres = misunderstood(layer);
    MirrorOptics start = layer.optics;
    start.reflectivity = 0.5;
    const MirrorOptics all =
        fitted_optics({layer.brightness, layer.ceiling, kScale}, spheres, start, 2).optics;
    const int side = static_cast<int>(14 * kScale);
    const int corner = (layer.brightness.width() - side) / 2;
    const Image brightness = part_of(layer.brightness, corner, corner, side, side);
    const Image ceiling = part_of(layer.ceiling, corner, corner, side, side);
    std::vector<Point3> shifted = spheres;
    const auto shift = static_cast<float>(corner / kScale);
    for (Point3& p : shifted) {
        p.x -= shift;
        p.y -= shift;
    }
    const MirrorOptics middle =
        fitted_optics({brightness, ceiling, kScale}, shifted, start, 2).optics;
    EXPECT_NEAR(all.reflectivity, layer.optics.reflectivity, 0.03);
    EXPECT_NEAR(all.blur, layer.optics.blur, 0.003);
    EXPECT_GT(std::abs(middle.reflectivity - layer.optics.reflectivity),
              2 * std::abs(all.reflectivity - layer.optics.reflectivity));
}

TEST(OpticsFit, ErrorsOfReflectivityAndBlurHoldOnLayersOfTheModel) {
    testing::Pull reflectivity;
    testing::Pull blur;
    for (const std::uint64_t seed : {61U, 62U, 63U, 64U, 65U, 66U, 67U, 68U}) {
        const RenderedLayer layer = rendered_layer(12, kScale, 0.02, seed);
        MirrorOptics start = layer.optics;
        start.reflectivity -= 0.05;
        start.blur += 0.01;
        const OpticsFrame frame{layer.brightness, layer.ceiling, kScale};
        start = fitted_optics(frame, layer.spheres, start, 2).optics;
        const FittedOptics found = fitted_optics(frame, layer.spheres, start, 2);
        reflectivity.add((found.optics.reflectivity - layer.optics.reflectivity) /
                         found.error.reflectivity);
        blur.add((found.optics.blur - layer.optics.blur) / found.error.blur);
        EXPECT_LT(found.error.reflectivity, 0.01);
        EXPECT_LT(found.error.blur, 0.001);
    }
    for (const testing::Pull& pull : {reflectivity, blur}) {
        EXPECT_LT(std::abs(pull.mean()), 1);
        EXPECT_GT(pull.width(), 0.5);
        EXPECT_LT(pull.width(), 1.7);
    }
}

TEST(OpticsFit, PixelsAtTheCeilingHaveNoSay) {
    RenderedLayer layer = rendered_layer(9, kScale, 0.005, 19);
    layer.ceiling = Image(layer.brightness.width(), layer.brightness.height(), 0.8F);
    for (float& v : layer.brightness.pixels()) v = std::min(v, 0.8F);
    MirrorOptics start = layer.optics;
    start.reflectivity = 0.5;
    start.blur += 0.02;
    const MirrorOptics found =
        fitted_optics({layer.brightness, layer.ceiling, kScale}, layer.spheres, start, 2).optics;
    EXPECT_NEAR(found.reflectivity, layer.optics.reflectivity, 0.04);
    EXPECT_NEAR(found.blur, layer.optics.blur, 0.004);
}

}  // namespace
}  // namespace grainfield::tracking
