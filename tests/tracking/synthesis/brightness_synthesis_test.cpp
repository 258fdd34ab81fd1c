#include "tracking/synthesis/brightness_synthesis.h"

#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

using testing::displaced;
using testing::rendered_layer;
using testing::RenderedLayer;

constexpr double kScale = 10;
constexpr double kInside = 1.5;  // [a]

BrightnessStart known_start(const RenderedLayer& layer) {
    return {.spheres = displaced(layer, 0.02, 0.15, 5),
            .are_heights_known = true,
            .optics = layer.optics,
            .are_optics_known = true};
}

BrightnessStart unknown_start(const RenderedLayer& layer) {
    BrightnessStart start = known_start(layer);
    for (Point3& p : start.spheres) p.z = static_cast<float>(0.5 * (layer.height - 1));
    start.optics.reflectivity = 0.5;
    start.optics.blur += 0.02;
    start.are_heights_known = start.are_optics_known = false;
    return start;
}

BrightnessSynthesis found_in(const RenderedLayer& layer, const BrightnessStart& start) {
    return synthesise_brightness(layer.brightness, layer.ceiling, kScale, start, layer.height, 0,
                                 2);
}

/// The same spheres in a light that is a quarter brighter at one side and darker at the other.
RenderedLayer in_uneven_light(RenderedLayer layer) {
    const int width = layer.brightness.width();
    for (int y = 0; y < layer.brightness.height(); ++y) {
        for (int x = 0; x < width; ++x) {
            const float across = static_cast<float>(x) / static_cast<float>(width - 1) - 0.5F;
            layer.brightness(x, y) *= 1 + 0.5F * across;
            layer.brightness(x, y) += 0.06F * across;
        }
    }
    return layer;
}

/// RMS error per axis in the plane, of spheres well within the frame [a].
double plane_error(const RenderedLayer& layer, const BrightnessSynthesis& found) {
    const double far = layer.brightness.width() / kScale - kInside;
    double squares = 0;
    double n = 0;
    for (std::size_t i = 0; i < layer.spheres.size(); ++i) {
        const Point3& p = layer.spheres[i];
        if (static_cast<double>(std::min(p.x, p.y)) < kInside ||
            static_cast<double>(std::max(p.x, p.y)) > far) {
            continue;
        }
        const double x = static_cast<double>(found.spheres[i].x - p.x);
        const double y = static_cast<double>(found.spheres[i].y - p.y);
        squares += 0.5 * (x * x + y * y);
        n += 1;
    }
    return std::sqrt(squares / n);
}

TEST(BrightnessSynthesis, LightThatIsBrighterOnOneSideCostsLessThanHalfOfTheAccuracy) {
    const RenderedLayer even = rendered_layer(16, kScale, 0.01, 21);
    const RenderedLayer uneven = in_uneven_light(even);
    const BrightnessSynthesis with_even = found_in(even, known_start(even));
    const BrightnessSynthesis with_uneven = found_in(uneven, known_start(uneven));
    const double error = plane_error(even, with_even);
    // With one light for all: .0141 a, and a residual of .062.
    EXPECT_LT(error, 0.004);
    EXPECT_LT(plane_error(uneven, with_uneven), 1.5 * error);
    EXPECT_LT(with_uneven.residual_rms, 1.1 * with_even.residual_rms);
    EXPECT_EQ(with_even.uneven.gain.width(), even.brightness.width());
}

TEST(BrightnessSynthesis, OpticsAndHeightsAreFoundInUnevenLight) {
    const RenderedLayer layer = in_uneven_light(rendered_layer(16, kScale, 0.01, 22));
    const BrightnessSynthesis found = found_in(layer, unknown_start(layer));
    EXPECT_NEAR(found.optics.reflectivity, layer.optics.reflectivity, 0.06);  // of .5
    EXPECT_NEAR(found.optics.blur, layer.optics.blur, 0.004);
    EXPECT_LT(plane_error(layer, found), 0.008);
    EXPECT_LT(found.residual_rms, 0.5 * found.residual_before);
}

}  // namespace
}  // namespace grainfield::tracking
