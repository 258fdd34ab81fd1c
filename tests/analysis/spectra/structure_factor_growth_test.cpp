#include <cmath>
#include <complex>
#include <cstdint>
#include <string>
#include <utility>
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
StructureFactor run_of(int frames, double time, std::uint64_t seed, const Power& power,
                       Boundary boundary = Boundary::periodic) {
    RandomStream random(31, "modes", seed);
    const bool walls = boundary == Boundary::walls;  // of half the side: as many wavevectors
    StructureFactor sk({.k_max = 1.6}, square_box(walls ? 10 : 20, boundary), frames);
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

struct Pulls {
    int runs = 0;
    int beyond = 0;  // found not to be steady
    double squares = 0;

    double width() const { return std::sqrt(squares / runs); }
};

Pulls pulls_of(Estimator estimator, int frames, double time, double k_max, int runs) {
    const Boundary boundary = estimator == Estimator::raw ? Boundary::periodic : Boundary::walls;
    Pulls pulls;
    for (int seed = 0; seed < runs; ++seed) {
        const auto growth =
            run_of(
                frames, time, static_cast<std::uint64_t>(seed), [](int) { return 1.0; }, boundary)
                .growth(estimator, k_max);
        if (!growth) continue;
        ++pulls.runs;
        pulls.beyond += !growth->is_steady();
        pulls.squares += std::pow(std::log(growth->ratio) * growth->ratio / growth->error, 2);
    }
    return pulls;
}

// 1,000 runs each of 6 to 200 frames that forget themselves in 0.3 to 20 of them have at most 0.3 %
// beyond 3.5 errors. The width of honest pulls, the largest of three, is some 1.2.
TEST(SpectrumGrowth, OfSteadyRunsIsWithinItsError) {
    for (const Estimator estimator : {Estimator::raw, Estimator::connected, Estimator::neumann}) {
        for (const int frames : {6, 16, 64}) {
            for (const double time : {0.5, 5.0, 64.0}) {
                const Pulls pulls = pulls_of(estimator, frames, time, 1.6, 150);
                EXPECT_LE(pulls.beyond, 2) << frames << " " << time;
                if (pulls.runs < 100) continue;  // between walls slow modes have no S
                EXPECT_LT(pulls.width(), 1.6) << frames << " " << time;
                if (time < 1) {
                    EXPECT_GT(pulls.width(), 0.7) << frames << " " << time;
                    EXPECT_EQ(pulls.runs, 150) << frames << " " << time;
                }
            }
        }
    }
}

// From 1 to 4 in the mean of the first and the last third.
TEST(SpectrumGrowth, IsThatOfAPowerThatGrows) {
    const auto power = [](int f) { return 0.25 + 4.5 * f / 63; };
    for (const Estimator estimator : {Estimator::raw, Estimator::connected, Estimator::neumann}) {
        const Boundary boundary =
            estimator == Estimator::raw ? Boundary::periodic : Boundary::walls;
        const auto growth = run_of(64, 0.5, 7, power, boundary).growth(estimator, 1.6);
        ASSERT_TRUE(growth.has_value());
        // The first and the last six of 16 blocks of four frames.
        const double expected = power(40 + 12) / power(12);
        EXPECT_NEAR(std::log(growth->ratio / expected), 0, 3 * growth->error / growth->ratio);
        EXPECT_FALSE(growth->is_steady());
    }
}

TEST(SpectrumGrowth, OfATenthIsSteadyWhateverItsError) {
    EXPECT_TRUE((SpectrumGrowth{.ratio = 1.1, .error = 0.001}.is_steady()));
    EXPECT_TRUE((SpectrumGrowth{.ratio = 0.91, .error = 0.001}.is_steady()));
    EXPECT_FALSE((SpectrumGrowth{.ratio = 1.12, .error = 0.001}.is_steady()));
    EXPECT_TRUE((SpectrumGrowth{.ratio = 2, .error = 0.5}.is_steady()));
}

// A quarter of the range has a sixteenth of the waves, so that the whole range shows little.
TEST(SpectrumGrowth, IsFoundWhereAHalfOrAQuarterOfTheRangeGrows) {
    for (const double end : {0.5, 1.0}) {
        RandomStream random(32, "lowest modes");
        StructureFactor sk({.k_max = 2}, square_box(30), 60);
        for (int f = 0; f < 60; ++f) {
            StructureFactor::Sample sample{900, {}};
            for (const Mode& mode : sk.grid().modes()) {
                const double amplitude = mode.k < end ? 1 + 0.1 * f : 1;
                sample.rho.emplace_back(amplitude * random.normal(), amplitude * random.normal());
            }
            sk.add(std::move(sample));
        }
        const auto growth = sk.growth(Estimator::raw, 2);
        ASSERT_TRUE(growth.has_value());
        EXPECT_FALSE(growth->is_steady()) << end << " " << growth->ratio << " " << growth->error;
    }
}

TEST(SpectrumGrowth, IsNotToldFromTwoFramesOrTwoWaves) {
    const auto steady = [](int) { return 1.0; };
    EXPECT_FALSE(run_of(2, 0.5, 1, steady).growth(Estimator::raw, 1.6).has_value());
    EXPECT_TRUE(run_of(3, 0.5, 1, steady).growth(Estimator::raw, 1.6).has_value());
    EXPECT_FALSE(run_of(64, 0.5, 1, steady).growth(Estimator::raw, 0.4).has_value());  // two waves
    EXPECT_TRUE(run_of(64, 0.5, 1, steady).growth(Estimator::raw, 0.45).has_value());  // four
}

TEST(SpectrumGrowth, SaysWhichRatiosPassAsSteady) {
    // 3.5 errors of .2 in ln(ratio): exp(±.7) = .4966 and 2.014.
    const auto at = [](double ratio) {
        return SpectrumGrowth{.ratio = ratio, .error = 0.2 * ratio, .k_end = 0.5};
    };
    for (const double ratio : {0.51, 1.0, 2.0}) EXPECT_TRUE(at(ratio).is_steady()) << ratio;
    for (const double ratio : {0.48, 2.03}) EXPECT_FALSE(at(ratio).is_steady()) << ratio;
    const std::string said = measured_growth("s", at(1.3)).reason;
    EXPECT_NE(said.find("up to k = 0.5 /a; 0.5 to 2 passes as steady"), std::string::npos) << said;
    const std::string exact =
        measured_growth("s", {.ratio = 1, .error = 0.001, .k_end = 0.5}).reason;
    EXPECT_NE(exact.find("0.9 to 1.1 passes"), std::string::npos) << exact;
}

TEST(SpectrumGrowth, SaysItWithTheDigitsOfTheError) {
    EXPECT_NE(not_steady("S", {.ratio = 1.1234, .error = 0.0084, .k_end = 0.1})
                  .find("S up to k = 0.1 /a is 1.1234 ± 0.0084 times as large"),
              std::string::npos);
    EXPECT_NE(not_steady("S", {.ratio = 23.4, .error = 3.1, .k_end = 0.1}).find("23.4 ± 3.1 times"),
              std::string::npos);
}

}  // namespace
}  // namespace grainfield::analysis
