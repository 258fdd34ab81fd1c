#include "tracking/model/background_surface.h"

#include <gtest/gtest.h>

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

TEST(BackgroundSurface, OfBlocksSeesTheSameLightInPixels) {
    const BackgroundSurface blocks(30, 20, 2, {180, 3, -2, 5, 1, -4});
    EXPECT_NEAR(blocks.in_pixels(3)(13, 22), blocks(4, 7), 1e-12);
}

}  // namespace
}  // namespace grainfield::tracking
