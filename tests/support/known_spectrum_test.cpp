#include "tests/support/known_spectrum.h"

#include <cmath>

#include <gtest/gtest.h>

namespace grainfield::testing {
namespace {

KnownSpectrumOptions small() {
    KnownSpectrumOptions options;
    options.side = 40;
    options.liquids = 2;
    options.melt = 20;
    options.wanted = {.s0 = 0.05, .s1 = 1, .alpha = 1, .peak = 0.4, .cut = 0.6};
    return options;
}

TEST(KnownSpectrum, GivesEachWaveItsAmplitudeToTenDigits) {
    KnownSpectrumLayer layer(small());
    for (int f = 0; f < 5; ++f) {
        const SlitScene scene = layer.next();
        ASSERT_EQ(scene.position.size(), layer.grains());
        for (std::size_t w = 0; w < layer.waves().size(); ++w) {
            const auto& wave = layer.waves()[w];
            double c = 0;  // by its definition
            for (const Vec2 r : scene.position) {
                c += std::cos(M_PI * wave.n * r.x / 40) * std::cos(M_PI * wave.m * r.y / 40);
            }
            EXPECT_NEAR(c, wave.wanted, 1e-9 * std::sqrt(static_cast<double>(layer.grains())));
        }
    }
}

TEST(KnownSpectrum, KeepsSpheresInTheCellAndAlmostApart) {
    KnownSpectrumLayer layer(small());
    for (int f = 0; f < 5; ++f) {
        const SlitScene scene = layer.next();
        for (const Vec2 r : scene.position) {
            EXPECT_GT(std::min(r.x, r.y), 0.4);
            EXPECT_LT(std::max(r.x, r.y), 39.6);
        }
        EXPECT_GT(closest_approach(scene), 0.6);
    }
}

// Squares of 40 independent frames × 70 waves in units of their mean: 1 with a standard error of
// sqrt(2/2800) = .027, and the mean square of Gaussian squares is 3 (standard error
// sqrt(96/2800) = .19). Bars: five standard errors.
TEST(KnownSpectrum, DrawsGaussianAmplitudesOfTheWantedSpectrum) {
    KnownSpectrumOptions options = small();
    options.tolerance = 1e-3;
    KnownSpectrumLayer layer(options);
    double square = 0, fourth = 0, count = 0;
    for (int f = 0; f < 40; ++f) {
        const std::vector<double> c = layer.amplitudes(layer.next().position);
        for (std::size_t w = 0; w < c.size(); ++w) {
            const double x = c[w] / layer.waves()[w].width;
            square += x * x;
            fourth += x * x * x * x;
            count += 1;
        }
    }
    ASSERT_GT(count, 1500);
    EXPECT_NEAR(square / count, 1, 5 * std::sqrt(2 / count));
    EXPECT_NEAR(fourth / count, 3, 5 * std::sqrt(96 / count));
}

TEST(KnownSpectrum, RelaxesAsDiffusionDoes) {
    KnownSpectrumOptions options = small();
    options.tolerance = 1e-3;
    options.diffusion = 5;
    KnownSpectrumLayer layer(options);
    std::vector<double> before = layer.amplitudes(layer.next().position);
    double product = 0, expected = 0;
    const int frames = 40;
    for (int f = 1; f < frames; ++f) {
        const std::vector<double> now = layer.amplitudes(layer.next().position);
        for (std::size_t w = 0; w < now.size(); ++w) {
            const auto& wave = layer.waves()[w];
            product += before[w] * now[w] / (wave.width * wave.width);
            expected += std::exp(-5 * wave.k * wave.k);
        }
        before = now;
    }
    // With 53 waves and 39 steps the mean of the products has a standard deviation of .05 (eight
    // seeds), about .48.
    const auto waves = static_cast<double>(before.size());
    EXPECT_NEAR(product / (frames - 1), expected / (frames - 1), 0.25 * waves);
}

TEST(KnownSpectrum, HasAStraightFlankBeyondItsPeak) {
    const WantedSpectrum wanted{.s0 = 0.1, .s1 = 2, .alpha = 1.5, .peak = 0.25, .cut = 0.4};
    EXPECT_DOUBLE_EQ(wanted.at(0.09), 0.1 + 2 * 0.027);
    EXPECT_DOUBLE_EQ(wanted.at(0.325), 0.5 * (0.1 + 2 * 0.125 + 0.12));
    EXPECT_DOUBLE_EQ(wanted.at(0.5), 0.12);
}

}  // namespace
}  // namespace grainfield::testing
