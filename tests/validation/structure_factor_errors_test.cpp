// Errors of S(k) against many trials with known S. The pull (S − true S)/error has the mean 0 and
// the width 1 if the errors are right. The width of P pulls is known to about 1.5/sqrt(2 P) (their
// tails are longer than a normal's): 2.4 % for the fewest here, 2000, so that the bars 0.85–1.15
// are 6 standard errors away from an honest 1 (false alarm < 1e-6).

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "analysis/spectra/structure_factor.h"
#include "tests/analysis/synthetic_patterns.h"
#include "tests/support/pull.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

using grainfield::testing::Pull;

// The pulls of all shells with at least `modes` modes; each pattern is shown `repeat` times in a
// row, so that frames are correlated.
Pull pulls(const Box& box, const char* curve_name, int frames, int repeat, int trials, double modes,
           double k_max) {
    Pull pull;
    for (int trial = 0; trial < trials; ++trial) {
        StructureFactor sk({.k_max = k_max}, box, frames);
        Pattern p;
        for (int f = 0; f < frames; ++f) {
            if (f % repeat == 0) {
                RandomStream random(static_cast<std::uint64_t>(1000 * frames + 10 * repeat),
                                    "coverage", static_cast<std::uint64_t>(trial * 1000 + f));
                p = pattern(poisson_points(300, box, random), box, f);
            }
            sk.add(sk.measure(p));
        }
        const ObservableResult result = sk.result();
        const Curve* curve = result.find_curve(curve_name);
        for (std::size_t i = 0; i < curve->find("k")->values.size(); ++i) {
            const double error = curve->find("s_err")->values[i];
            if (curve->find("n")->values[i] < modes || !std::isfinite(error)) continue;
            pull.add((curve->find("s")->values[i] - 1) / error);
        }
    }
    return pull;
}

class StructureFactorErrors : public ::testing::TestWithParam<std::array<int, 3>> {};

TEST_P(StructureFactorErrors, CoverTheTruthForPoissonFrames) {
    const auto [frames, repeat, trials] = GetParam();
    const Box walls = square_box(20, Boundary::walls);
    for (const char* curve : {"sk", "sk_neumann"}) {
        const Pull pull = pulls(walls, curve, frames, repeat, trials, 6, 1.5);
        EXPECT_GE(pull.count, 2000) << curve;
        EXPECT_GT(pull.width(), 0.85) << curve;
        EXPECT_LT(pull.width(), 1.15) << curve << ", mean " << pull.mean();
    }
    const Pull pull = pulls(square_box(20), "sk", frames, repeat, trials, 4, 3);
    EXPECT_GT(pull.width(), 0.85) << "periodic";
    EXPECT_LT(pull.width(), 1.15) << "periodic";
    EXPECT_GE(pull.count, 2000) << "periodic";
}

INSTANTIATE_TEST_SUITE_P(
    Frames, StructureFactorErrors,
    ::testing::Values(std::array<int, 3>{2, 1, 500}, std::array<int, 3>{3, 1, 500},
                      std::array<int, 3>{7, 1, 500}, std::array<int, 3>{8, 1, 500},
                      std::array<int, 3>{40, 1, 500}, std::array<int, 3>{64, 4, 500}));

}  // namespace
}  // namespace grainfield::analysis
