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

BrightnessSynthesis found_in(const RenderedLayer& layer) {
    const BrightnessStart start{.spheres = displaced(layer, 0.02, 0.15, 5),
                                .are_heights_known = true,
                                .optics = layer.optics,
                                .are_optics_known = true};
    return synthesise_brightness(layer.brightness, layer.ceiling, kScale, start, layer.height, 0,
                                 2);
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

TEST(BrightnessSynthesis, LightThatIsBrighterOnOneSideCostsNoAccuracy) {
    const RenderedLayer even = rendered_layer(16, kScale, 0.01, 21);
    RenderedLayer uneven = even;
    const int width = uneven.brightness.width();
    for (int y = 0; y < uneven.brightness.height(); ++y) {
        for (int x = 0; x < width; ++x) {
            const float across = static_cast<float>(x) / static_cast<float>(width - 1) - 0.5F;
            uneven.brightness(x, y) *= 1 + 0.5F * across;
            uneven.brightness(x, y) += 0.06F * across;
        }
    }
    const BrightnessSynthesis in_even_light = found_in(even);
    const BrightnessSynthesis in_uneven_light = found_in(uneven);
    const double error = plane_error(even, in_even_light);
    EXPECT_LT(error, 0.006);
    EXPECT_LT(plane_error(uneven, in_uneven_light), 1.7 * error);
    EXPECT_LT(in_uneven_light.residual_rms, 1.3 * in_even_light.residual_rms);
}

}  // namespace
}  // namespace grainfield::tracking
