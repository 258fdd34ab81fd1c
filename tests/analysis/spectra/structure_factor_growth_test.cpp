#include <cmath>
#include <complex>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "analysis/spectra/structure_factor.h"
#include "core/support/random.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;
using Estimator = StructureFactor::Estimator;

// Modes that forget themselves in `time` frames, of variance one, times sqrt(power(frame)).
template <class Power>
StructureFactor run_of(int frames, double time, std::uint64_t seed, const Power& power) {
    RandomStream random(31, "modes", seed);
    StructureFactor sk({.k_max = 1.6}, square_box(20), frames);
    const std::size_t modes = sk.grid().modes().size();
    const double keep = std::exp(-1 / time);
    std::vector<std::complex<double>> state(modes);
    for (auto& mode : state) mode = {random.normal(), random.normal()};
    for (int f = 0; f < frames; ++f) {
        StructureFactor::Sample sample{400, {}};
        for (auto& mode : state) {
            const std::complex<double> kick{random.normal(), random.normal()};
            mode = keep * mode + std::sqrt(1 - keep * keep) * kick;
            sample.rho.push_back(std::sqrt(power(f)) * mode);
        }
        sk.add(std::move(sample));
    }
    return sk;
}

// Runs from a hundred times as long as the modes remember themselves to as long as that. In the
// mean over all, one in some 200 is expected beyond three errors; 3 of 150 are allowed of each.
TEST(SpectrumGrowth, OfSteadyRunsIsWithinItsError) {
    for (const double time : {0.5, 5.0, 20.0, 64.0}) {
        int beyond = 0;
        for (std::uint64_t seed = 0; seed < 150; ++seed) {
            const auto growth =
                run_of(64, time, seed, [](int) { return 1.0; }).growth(Estimator::raw, 1.6);
            ASSERT_TRUE(growth.has_value());
            beyond += !growth->is_steady();
        }
        EXPECT_LE(beyond, 3) << time;
    }
}

TEST(SpectrumGrowth, IsThatOfAPowerThatGrows) {
    // From 1 to 4 in the mean of the first and the last third.
    const auto power = [](int f) { return 0.25 + 4.5 * f / 63; };
    const auto growth = run_of(64, 0.5, 7, power).growth(Estimator::raw, 1.6);
    ASSERT_TRUE(growth.has_value());
    const double expected = power(53) / power(10);
    EXPECT_NEAR(std::log(growth->ratio / expected), 0, 3 * growth->error / growth->ratio);
    EXPECT_FALSE(growth->is_steady());
    EXPECT_GT(run_of(64, 0.5, 7, [&](int f) { return power(63 - f); })
                  .growth(Estimator::raw, 1.6)
                  ->samples,
              2);
}

TEST(SpectrumGrowth, IsFoundInAnyHalfAndQuarterOfTheRange) {
    RandomStream random(32, "lowest modes");
    StructureFactor sk({.k_max = 2}, square_box(30), 60);
    for (int f = 0; f < 60; ++f) {
        StructureFactor::Sample sample{900, {}};
        for (const Mode& mode : sk.grid().modes()) {
            const double amplitude = mode.k < 0.5 ? 1 + 0.1 * f : 1;
            sample.rho.emplace_back(amplitude * random.normal(), amplitude * random.normal());
        }
        sk.add(std::move(sample));
    }
    const auto growth = sk.growth(Estimator::raw, 2);
    ASSERT_TRUE(growth.has_value());
    EXPECT_DOUBLE_EQ(growth->k_end, 0.5);
    EXPECT_FALSE(growth->is_steady());
}

TEST(SpectrumGrowth, IsNotToldFromTwoFramesOrThreeWaves) {
    const auto steady = [](int) { return 1.0; };
    EXPECT_FALSE(run_of(2, 0.5, 1, steady).growth(Estimator::raw, 1.6).has_value());
    EXPECT_TRUE(run_of(3, 0.5, 1, steady).growth(Estimator::raw, 1.6).has_value());
    EXPECT_FALSE(run_of(64, 0.5, 1, steady).growth(Estimator::raw, 0.4).has_value());
}

}  // namespace
}  // namespace grainfield::analysis
