#include "analysis/statistics/ornstein_zernike.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/pull.h"

namespace grainfield::analysis {
namespace {

using grainfield::testing::Pull;

/// Shells as those of a box of side 100 a; ν modes each, if `random` is given scattered.
Spectrum shells_of(double s_zero, double xi, int nu, RandomStream* random) {
    Spectrum spectrum;
    for (int i = 1; i <= 12; ++i) {
        const double k = 0.0628 * i;
        double s = s_zero / (1 + xi * xi * k * k);
        if (random != nullptr) {
            double sum = 0;
            for (int n = 0; n < nu; ++n) sum -= std::log(1 - random->uniform());
            s *= sum / nu;
        }
        spectrum.k.push_back(k);
        spectrum.s.push_back(s);
        spectrum.dof.push_back(nu);
        spectrum.error.push_back(s / std::sqrt(nu));
    }
    return spectrum;
}

TEST(OrnsteinZernike, OfAnExactSpectrumGivesItsParameters) {
    for (const double xi : {0.5, 3.0, 40.0}) {
        for (const double s_zero : {0.2, 90.0}) {
            const auto fit = fit_ornstein_zernike(shells_of(s_zero, xi, 10, nullptr), 1);
            ASSERT_TRUE(fit.ok()) << fit.reason;
            EXPECT_NEAR(fit.s_zero / s_zero, 1, 1e-6) << xi;
            EXPECT_NEAR(fit.xi / xi, 1, 1e-6) << s_zero;
            EXPECT_LT(fit.chi2_per_dof, 1e-9);
            EXPECT_NEAR(fit.value(0.1), s_zero / (1 + 0.01 * xi * xi), 1e-6 * s_zero);
        }
    }
}

// 500 trials: the mean of an honest pull has a standard error of 0.045 and its width of 0.032; the
// error is scaled by the scatter where that exceeds one, which widens it by some 5 %.
TEST(OrnsteinZernike, CoversTheTruthNominally) {
    RandomStream random(5, "ornstein-zernike");
    Pull of_s_zero, of_xi;
    for (int trial = 0; trial < 500; ++trial) {
        const auto fit = fit_ornstein_zernike(shells_of(20, 5, 60, &random), 1);
        ASSERT_TRUE(fit.ok()) << fit.reason;
        of_s_zero.add((fit.s_zero - 20) / fit.s_zero_error);
        of_xi.add((fit.xi - 5) / fit.xi_error);
    }
    EXPECT_NEAR(of_s_zero.mean(), 0, 0.2);
    EXPECT_NEAR(of_s_zero.width(), 1, 0.15);
    EXPECT_NEAR(of_xi.mean(), 0, 0.2);
    EXPECT_NEAR(of_xi.width(), 1, 0.15);
}

TEST(OrnsteinZernike, SaysWhyThereIsNone) {
    Spectrum rising = shells_of(1, 1, 10, nullptr);
    for (std::size_t i = 0; i < rising.k.size(); ++i) rising.s[i] = 1 + rising.k[i];
    EXPECT_EQ(fit_ornstein_zernike(rising, 1).reason, "S does not fall with k");
    EXPECT_NE(fit_ornstein_zernike(shells_of(1, 1, 10, nullptr), 0.13).reason, "");
    EXPECT_NE(fit_ornstein_zernike({}, 1).reason, "");
    // 1/k³: the line through 1/S would cross zero.
    Spectrum diverging = shells_of(1, 1, 1000, nullptr);
    for (std::size_t i = 0; i < diverging.k.size(); ++i) {
        diverging.s[i] = std::pow(diverging.k[i], -3);
    }
    EXPECT_EQ(fit_ornstein_zernike(diverging, 1).reason, "S has no finite limit at k = 0");
}

TEST(OrnsteinZernike, TheRangeIsTheOneAskedFor) {
    Spectrum spectrum = shells_of(20, 5, 60, nullptr);
    for (std::size_t i = 6; i < spectrum.k.size(); ++i) spectrum.s[i] = 100;
    const auto fit = fit_ornstein_zernike(spectrum, 0.39);
    ASSERT_TRUE(fit.ok());
    EXPECT_EQ(fit.points, 6);
    EXPECT_NEAR(fit.xi, 5, 1e-5);
}

}  // namespace
}  // namespace grainfield::analysis
