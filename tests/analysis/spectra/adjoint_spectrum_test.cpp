#include "analysis/spectra/adjoint_spectrum.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/pull.h"

namespace grainfield::analysis {
namespace {

using grainfield::testing::Pull;

/// Two waves of k = 0.5 that see the same slow order field (correlation of `length` stretches) and
/// have little noise of their own; true S = 2.
std::vector<WaveSamples> twins(std::size_t stretches, double length, RandomStream& random) {
    std::vector<WaveSamples> waves{{0.5, {}}, {0.5, {}}};
    const double keep = std::exp(-1 / length);
    double slow = random.normal();
    for (std::size_t i = 0; i < stretches; ++i) {
        for (WaveSamples& wave : waves) wave.s.push_back(2 + slow + 0.1 * random.normal());
        slow = keep * slow + std::sqrt(1 - keep * keep) * random.normal();
    }
    return waves;
}

// 400 trials: the width of an honest pull has a standard error of 3.5 %, more for few blocks.
// Blocks of 6 correlation times leave about 8 % of correlation between them.
TEST(AdjointSpectrum, ErrorsCoverSharedAndSlowOrder) {
    RandomStream random(1, "adjoint");
    Pull pull;
    for (int trial = 0; trial < 400; ++trial) {
        const auto waves = twins(600, 6, random);
        const ObservableResult result = adjoint_spectrum(waves, 16);
        const Measurement& m = result.measurements.front();
        pull.add((m.value.value() - 2) / m.error.value());
    }
    EXPECT_NEAR(pull.mean(), 0, 0.2);
    EXPECT_NEAR(pull.width(), 1.05, 0.2);
}

TEST(AdjointSpectrum, PoolsWavesOfOneLength) {
    const std::vector<WaveSamples> waves{{0.5, {1, 2, 3, 4}}, {0.25, {7, 7, 7, 7}}, {0.5, {3, 4}}};
    const ObservableResult result = adjoint_spectrum(waves, 100);
    const Curve& curve = result.curves.front();
    EXPECT_EQ(curve.find("k")->values, (std::vector<double>{0.25, 0.5}));
    EXPECT_NEAR(curve.find("s")->values[1], 17.0 / 6, 1e-12);
    EXPECT_EQ(curve.find("n")->values[1], 6);
    EXPECT_EQ(curve.find("s_err")->values[0], 0);
    EXPECT_TRUE(std::isnan(curve.find("s_err")->values[1])) << "two blocks only";
}

TEST(AdjointSpectrum, WithoutEnoughTimeThereIsNoError) {
    RandomStream random(2, "adjoint");
    const ObservableResult few = adjoint_spectrum(twins(600, 6, random), 3.9);
    EXPECT_TRUE(few.measurements.front().value.has_value());
    EXPECT_FALSE(few.measurements.front().error.has_value());
    EXPECT_FALSE(few.measurements.front().reason.empty());
    const ObservableResult none = adjoint_spectrum(std::vector<WaveSamples>{{0.5, {}}}, 100);
    EXPECT_FALSE(none.measurements.front().value.has_value());
}

}  // namespace
}  // namespace grainfield::analysis
