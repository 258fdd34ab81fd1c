// The whole way from density modes to S0, S1 and their errors: Gaussian random fields with
// S(k) = S0 + S1 (ka)^α whose modes relax exponentially, so that frames are correlated.

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

#include "analysis/spectra/fit_result.h"
#include "tests/analysis/synthetic_patterns.h"
#include "tests/support/pull.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

using grainfield::testing::Pull;

// 500 trials: the bars 0.15 and 0.85–1.15 are those asked for; the mean of an honest pull has a
// standard error of 0.045 and its width of 0.032, and the seed is fixed.
TEST(FitTheory, OfCorrelatedGaussianFieldsCoversTheTruthWithBootstrapAndLikelihood) {
    const int frames = 160;
    const double keep = 0.5;  // correlation from frame to frame: blocks hold ten of them
    const double particles = 4000;
    const Box box = square_box(60);
    for (double s0 : {0.01, 0.1}) {
        Pull resampled, likelihood;
        int unsteady = 0;  // one in a thousand is found so by chance
        for (std::uint64_t trial = 0; trial < 500; ++trial) {
            StructureFactor sk({.k_max = 1}, box, frames);
            RandomStream random(51, "gaussian field", trial);
            const auto& modes = sk.grid().modes();
            std::vector<std::complex<double>> rho(modes.size());
            for (int f = 0; f < frames; ++f) {
                for (std::size_t m = 0; m < modes.size(); ++m) {
                    const double s = s0 + std::pow(modes[m].k, 1.12);
                    const double width = std::sqrt(0.5 * particles * s);
                    const std::complex<double> fresh{width * random.normal(),
                                                     width * random.normal()};
                    rho[m] = f == 0 ? fresh : keep * rho[m] + std::sqrt(1 - keep * keep) * fresh;
                }
                sk.add({particles, rho});
            }
            const ObservableResult fit = fit_result(sk, {.k_max = 0.9, .bootstrap = 60});
            ASSERT_EQ(fit.reason, "");
            const Measurement* m = fit.find_measurement("s0");
            if (!m->value) {
                ASSERT_NE(m->reason.find("not steady"), std::string::npos) << m->reason;
                ++unsteady;
                continue;
            }
            ASSERT_TRUE(m->error.has_value()) << m->reason;
            resampled.add((*m->value - s0) / *m->error);
            const SpectrumFit direct =
                fit_spectrum(sk.spectrum(StructureFactor::Estimator::raw), 0.9, 1.12);
            likelihood.add((direct.s0 - s0) / direct.error[0]);
        }
        EXPECT_LE(unsteady, 3) << s0;
        for (const auto& [name, pull] :
             {std::pair{"bootstrap", resampled}, std::pair{"likelihood", likelihood}}) {
            EXPECT_LT(std::abs(pull.mean()), 0.15) << name << " " << s0;
            EXPECT_GT(pull.width(), 0.85) << name << " " << s0;
            EXPECT_LT(pull.width(), 1.15) << name << " " << s0;
        }
    }
}

TEST(FitTheory, GivesReasonsForOneFrameAndWithoutAPrePeak) {
    const Box walls = square_box(30, Boundary::walls);
    RandomStream random(52, "reasons");
    StructureFactor one({}, walls, 1);
    one.add(one.measure(pattern(poisson_points(900, walls, random), walls)));
    EXPECT_NE(fit_result(one, {}).reason.find("one frame"), std::string::npos);
    StructureFactor flat({}, walls, 20);
    for (int f = 0; f < 20; ++f) {
        flat.add(flat.measure(pattern(poisson_points(900, walls, random), walls, f)));
    }
    EXPECT_NE(why_no_fit(fit_result(flat, {})).find("--fit-k-max"), std::string::npos);
    const ObservableResult given = fit_result(flat, {.k_max = 1.5});
    ASSERT_EQ(given.reason, "");
    EXPECT_NE(given.find_measurement("s0_over_s1_connected"), nullptr);
    EXPECT_NE(given.find_measurement("s0_over_s1_systematic_alpha"), nullptr);
    EXPECT_NE(given.find_curve("fit"), nullptr);
}

// The two spectra of a walled box change places, and the stored fit says which one it was made of.
TEST(FitTheory, TakesPlaneWavesBetweenWallsIfAskedTo) {
    const Box walls = square_box(30, Boundary::walls);
    RandomStream random(53, "plane waves");
    StructureFactor sk({}, walls, 20);
    for (int f = 0; f < 20; ++f) {
        sk.add(sk.measure(pattern(square_lattice(30, 1, 0.3, random), walls, f)));
    }
    const FitOptions of_box{.k_max = 1.5, .bootstrap = 0};
    const FitOptions of_planes{.k_max = 1.5, .modes = FitModes::plane_waves, .bootstrap = 0};
    const ObservableResult box = fit_result(sk, of_box);
    const ObservableResult planes = fit_result(sk, of_planes);
    const auto value = [](const ObservableResult& fit, const char* name) {
        const Measurement* m = fit.find_measurement(name);
        return m != nullptr && m->value ? *m->value : std::nan("");
    };
    EXPECT_EQ(value(planes, "s0_over_s1"), value(box, "s0_over_s1_connected"));
    EXPECT_EQ(value(planes, "s0_over_s1_neumann"), value(box, "s0_over_s1"));
    EXPECT_NE(value(planes, "s0_over_s1"), value(box, "s0_over_s1"));
    EXPECT_EQ(recorded_modes(box), FitModes::box);
    EXPECT_EQ(recorded_modes(planes), FitModes::plane_waves);
    const ObservableResult stored = sk.result();
    for (const auto& [fit, curve] : {std::pair{&box, "sk_neumann"}, std::pair{&planes, "sk"}}) {
        const FitModes modes = recorded_modes(*fit);
        EXPECT_EQ(recorded_spectrum(stored, modes).s, stored.find_curve(curve)->find("s")->values);
        EXPECT_EQ(fitted_spectrum(sk, modes).s, stored.find_curve(curve)->find("s")->values);
    }
}

}  // namespace
}  // namespace grainfield::analysis
