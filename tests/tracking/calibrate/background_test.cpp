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

TEST(BackgroundSurface, ReproducesAPolynomialOfItsDegree) {
    std::vector<BackgroundSurface::Sample> samples;
    for (int y = 0; y < 300; y += 20) {
        for (int x = 0; x < 400; x += 20) {
            samples.push_back({double(x), double(y), lamp(x, y), 1.0 + x});
        }
    }
    const auto surface = BackgroundSurface::fit(400, 300, 2, samples);
    std::vector<float> row(400);
    surface.row(123, 400, row.data());
    for (int x = 0; x < 400; x += 7) {
        EXPECT_NEAR(surface(x, 123), lamp(x, 123), 1e-8);
        EXPECT_NEAR(row[static_cast<std::size_t>(x)], lamp(x, 123), 2e-5);
    }
}

TEST(BackgroundSurface, FallsBackWhenSamplesDoNotDetermineIt) {
    const auto surface = BackgroundSurface::fit(100, 100, 3, {{10, 10, 5, 1}, {20, 20, 7, 3}});
    EXPECT_TRUE(surface.is_uniform());
    EXPECT_DOUBLE_EQ(surface(50, 50), 6.5);
}

TEST(BackgroundSurface, ShiftedSeesTheSameLight) {
    const auto surface = BackgroundSurface::fit(100, 100, 1,
                                                {{0, 0, 1, 1},
                                                 {99, 0, 2, 1},
                                                 {0, 99, 3, 1},
                                                 {99, 99, 4, 1},
                                                 {50, 50, 2.5, 1},
                                                 {20, 70, 2.3, 1},
                                                 {70, 20, 1.9, 1},
                                                 {10, 40, 1.9, 1},
                                                 {40, 10, 1.6, 1}});
    EXPECT_NEAR(surface.shifted(30, 10)(5, 6), surface(35, 16), 1e-12);
    EXPECT_NEAR(surface.negated()(5, 6), -surface(5, 6), 1e-12);
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
