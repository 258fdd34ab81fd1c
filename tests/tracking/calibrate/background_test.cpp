#include "tracking/calibrate/background.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

double lamp(double x, double y) {
    return 180 + 0.05 * x - 0.03 * y - 1e-4 * (x - 150) * (x - 150) + 5e-5 * x * y;
}

TEST(UpperEnvelope, FollowsUnevenLightThroughALayerWithADarkPatch) {
    Image counts(400, 300);
    const auto scene = testing::hard_disc_liquid(400, 300, 12, 0.6, 2);
    const Image discs = testing::tanh_frame(scene, 12, 1, 0, 1);
    for (int y = 0; y < 300; ++y) {
        for (int x = 0; x < 400; ++x) {
            const double transmission = (static_cast<double>(discs(x, y)) - 30) / 170;
            const bool crystal = std::hypot(x - 250, y - 150) < 60;
            counts(x, y) = static_cast<float>(lamp(x, y) * (crystal ? 0.1 : transmission));
        }
    }
    const auto surface = upper_envelope(counts, 170, 0.003);
    for (int y = 20; y < 300; y += 40) {
        // 5 % of the contrast: it only has to carry the first threshold.
        for (int x = 20; x < 400; x += 40) EXPECT_NEAR(surface(x, y), lamp(x, y), 8.5);
    }
}

TEST(UpperEnvelope, IsUniformWhereTheLightIs) {
    EXPECT_TRUE(upper_envelope(Image(100, 80, 200.0F), 100, 0.003).is_uniform());
}

}  // namespace
}  // namespace grainfield::tracking
