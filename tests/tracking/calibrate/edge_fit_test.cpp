#include "tracking/calibrate/edge_fit.h"

#include <numbers>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

Image discs_with_noise(const std::vector<Vec2>& centres, const DiscProfile& disc, double amplitude,
                       double noise, int size) {
    RandomStream random(11, "edge fit noise");
    Image image(size, size);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            double transmission = 1;
            for (const Vec2 c : centres) {
                transmission *= 1 - disc.darkness(std::hypot(x - c.x, y - c.y));
            }
            image(x, y) =
                static_cast<float>(amplitude * (1 - transmission) + noise * random.normal());
        }
    }
    return image;
}

TEST(EdgeFit, RecoversDiameterEdgeAndAmplitudeWithinFiveBounds) {
    const DiscProfile truth{16, 1.2};
    std::vector<Vec2> centres;
    for (int i = 0; i < 5; ++i) {
        for (int j = 0; j < 5; ++j) centres.push_back({20.2 + 30 * i, 19.7 + 30.1 * j});
    }
    const Image image = discs_with_noise(centres, truth, 0.9, 0.02, 160);
    const EdgeFit fit = fit_exposed_edges(image, centres, {14.5, 1.7});
    EXPECT_TRUE(fit.converged);
    // σ_D = (σ/C) sqrt(12 w/(π D N)) = 0.0024 px; w and A are of the same order.
    const double bound = 0.02 / 0.9 * std::sqrt(12 * 1.2 / (std::numbers::pi * 16 * 25));
    EXPECT_NEAR(fit.disc.diameter, 16, 5 * bound);
    EXPECT_NEAR(fit.disc.edge_width, 1.2, 5 * bound);
    EXPECT_NEAR(fit.amplitude, 0.9, 0.002);
    EXPECT_NEAR(fit.rms, 0.02, 0.001);
}

TEST(EdgeFit, IgnoresEdgesThatTouchOthers) {
    const DiscProfile truth{16, 1.2};
    // Two isolated discs and a cluster of three that overlap.
    const std::vector<Vec2> centres{{30, 30}, {30.4, 110.3}, {100, 60}, {111, 60}, {105.5, 70}};
    const Image image = discs_with_noise(centres, truth, 1, 0, 150);
    const EdgeFit fit = fit_exposed_edges(image, centres, {15, 1.5});
    EXPECT_NEAR(fit.disc.diameter, 16, 0.02);
    EXPECT_NEAR(fit.disc.edge_width, 1.2, 0.02);
}

TEST(EdgeFit, WithoutExposedEdgesKeepsTheStart) {
    const EdgeFit fit = fit_exposed_edges(Image(50, 50), {}, {12, 1});
    EXPECT_EQ(fit.pixels, 0);
    EXPECT_EQ(fit.disc.diameter, 12);
}

}  // namespace
}  // namespace grainfield::tracking
