#include "analysis/statistics/spectrum_fit.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/pull.h"

namespace grainfield::analysis {
namespace {

// A gamma-distributed number of mean 1 and shape n (Marsaglia and Tsang 2000), n ≥ 1.
double gamma_of_mean_one(double n, RandomStream& random) {
    const double d = n - 1.0 / 3;
    const double c = 1 / std::sqrt(9 * d);
    for (;;) {
        const double x = random.normal();
        const double v = std::pow(1 + c * x, 3);
        if (v <= 0) continue;
        const double u = random.uniform();
        if (std::log(u) < 0.5 * x * x + d - d * v + d * std::log(v)) return d * v / n;
    }
}

// Shells of the cos·cos modes of a square box of side 100 a, `frames` independent frames.
Spectrum spectrum(double s0, double s1, double alpha, double frames, RandomStream* random) {
    Spectrum out;
    const double step = std::numbers::pi / 100;
    for (int i = 1; i <= 40; ++i) {
        const double k = i * step;
        const double modes = std::max(1.0, std::numbers::pi / 2 * i);
        const double nu = modes * frames / 2;
        const double mu = s0 + s1 * std::pow(k, alpha);
        out.k.push_back(k);
        out.s.push_back(random != nullptr ? mu * gamma_of_mean_one(nu, *random) : mu);
        out.dof.push_back(nu);
        out.error.push_back(out.s.back() / std::sqrt(nu));
    }
    return out;
}

TEST(Fit, OfAnExactSpectrumGivesItsParameters) {
    for (double s0 : {-0.001, 0.0, 0.01, 1.0}) {
        const Spectrum exact = spectrum(s0, 0.7, 1.12, 50, nullptr);
        for (FitMethod method : {FitMethod::whittle, FitMethod::least_squares}) {
            const SpectrumFit fixed = fit_spectrum(exact, 1, 1.12, method);
            ASSERT_TRUE(fixed.ok()) << fixed.reason;
            EXPECT_NEAR(fixed.s0, s0, 1e-10);
            EXPECT_NEAR(fixed.s1, 0.7, 1e-10);
        }
        const SpectrumFit free = fit_spectrum(exact, 1, std::nullopt);
        ASSERT_TRUE(free.ok()) << free.reason;
        EXPECT_NEAR(free.alpha, 1.12, 1e-5);  // the likelihood is flat to 1e-16 over 1e-7 or so
        EXPECT_NEAR(free.s0, s0, 1e-5);
    }
}

using grainfield::testing::Pull;

// 500 trials: the mean of an honest pull has a standard error of 0.045, its width of 0.032; the
// bars 0.15 and 0.85–1.15 are the requirement on a fit (3.3 and 4.7 standard errors; the seed is
// fixed).
TEST(Fit, CoversTheTruthNominallyWithAlphaFixedAndFree) {
    for (double s0 : {0.0, 0.01, 0.1}) {
        Pull of_s0, of_s1, of_ratio, free_s0, free_alpha;
        int inside = 0;
        for (std::uint64_t trial = 0; trial < 500; ++trial) {
            RandomStream random(41, "fit coverage", trial);
            const Spectrum data = spectrum(s0, 1, 1.12, 200, &random);
            const SpectrumFit fit = fit_spectrum(data, 1, 1.12);
            ASSERT_TRUE(fit.ok()) << fit.reason;
            of_s0.add((fit.s0 - s0) / fit.error[0]);
            of_s1.add((fit.s1 - 1) / fit.error[1]);
            of_ratio.add((fit.ratio() - s0) / fit.ratio_error());
            const auto interval = ratio_interval(data, fit);
            ASSERT_TRUE(interval.has_value());
            inside += interval->low < s0 && s0 < interval->high;
            const SpectrumFit free = fit_spectrum(data, 1, std::nullopt);
            ASSERT_TRUE(free.ok()) << free.reason;
            free_s0.add((free.s0 - s0) / free.error[0]);
            free_alpha.add((free.alpha - 1.12) / free.error[2]);
        }
        for (const auto& [name, pull] :
             {std::pair{"s0", of_s0}, std::pair{"s1", of_s1}, std::pair{"ratio", of_ratio},
              std::pair{"s0, free", free_s0}, std::pair{"alpha", free_alpha}}) {
            EXPECT_LT(std::abs(pull.mean()), 0.15) << name << " at S0 = " << s0;
            EXPECT_GT(pull.width(), 0.85) << name << " at S0 = " << s0;
            EXPECT_LT(pull.width(), 1.15) << name << " at S0 = " << s0;
        }
        // 68.3 % of 500: binomial standard deviation 10.4.
        EXPECT_NEAR(inside, 341, 5 * 10.4) << s0;
    }
}

TEST(Fit, WithWeightsFromTheDataIsBiasedLowAndTheLikelihoodIsNot) {
    Pull whittle, least_squares;
    for (std::uint64_t trial = 0; trial < 500; ++trial) {
        RandomStream random(42, "fit bias", trial);
        const Spectrum data = spectrum(0.05, 1, 1.12, 20, &random);
        whittle.add(fit_spectrum(data, 1, 1.12).s0);
        least_squares.add(fit_spectrum(data, 1, 1.12, FitMethod::least_squares).s0);
    }
    const double error = whittle.width() / std::sqrt(500.0);
    EXPECT_LT(std::abs(whittle.mean() - 0.05), 5 * error);
    EXPECT_LT(least_squares.mean(), 0.05 - 5 * error);
}

TEST(Fit, SharesOneExponentOverSeveralSpectra) {
    std::vector<Spectrum> spectra;
    std::vector<double> k_max;
    for (std::uint64_t i = 0; i < 6; ++i) {
        RandomStream random(43, "fit shared", i);
        spectra.push_back(spectrum(0.02 * static_cast<double>(i), 1 + 0.2 * static_cast<double>(i),
                                   1.3, 300, &random));
        k_max.push_back(1);
    }
    const auto fits = fit_shared(spectra, k_max);
    const SpectrumFit one = fit_spectrum(spectra[0], 1, std::nullopt);
    for (const SpectrumFit& fit : fits) {
        ASSERT_TRUE(fit.ok());
        EXPECT_EQ(fit.alpha, fits[0].alpha);
        EXPECT_LT(std::abs(fit.alpha - 1.3), 5 * fit.error[2]);
    }
    EXPECT_LT(fits[0].error[2], 0.8 * one.error[2]);
}

// A step is steeper than any power that is searched.
TEST(FitShared, IsNoneWhereTheExponentRunsToTheEndOfItsRange) {
    Spectrum step = spectrum(1, 0, 1, 100, nullptr);
    for (std::size_t i = 0; i < step.k.size(); ++i) step.s[i] = step.k[i] < 0.9 ? 1 : 3;
    const std::vector<Spectrum> spectra{step, step};
    for (const SpectrumFit& fit : fit_shared(spectra, std::vector<double>{1, 1})) {
        EXPECT_THAT(fit.reason, ::testing::HasSubstr("runs to the end of its range"));
    }
}

TEST(Fit, GivesReasonsWhereItCannotBeMade) {
    Spectrum few = spectrum(0.1, 1, 1.12, 100, nullptr);
    EXPECT_NE(fit_spectrum(few, 0.05, 1.12).reason, "");
    EXPECT_NE(fit_spectrum({}, 1, 1.12).reason, "");
    for (double& nu : few.dof) nu = std::nan("");
    EXPECT_NE(fit_spectrum(few, 1, 1.12).reason, "");
    Spectrum flat = spectrum(1, 0, 1, 100, nullptr);
    const SpectrumFit fit = fit_spectrum(flat, 1, 1.12);
    EXPECT_NEAR(fit.s0, 1, 1e-9);
    EXPECT_NEAR(fit.s1, 0, 1e-9);
}

TEST(Rise, IsKnownAboveTwoErrorsOfTheSlopeOnly) {
    EXPECT_TRUE(rises(0.21, 0.1));
    EXPECT_FALSE(rises(0.19, 0.1));
    EXPECT_FALSE(rises(-1, 0.1));
    EXPECT_FALSE(rises(1, std::nan("")));
}

TEST(Rise, SaysWhyThereIsNone) {
    using ::testing::HasSubstr;
    EXPECT_THAT(no_rise(0.2, 0.2), HasSubstr("S1 = 0.2 ± 0.2; a run 4 times as long"));
    EXPECT_THAT(no_rise(-2, 0.5), HasSubstr("S falls"));
    EXPECT_THAT(no_rise(-0.2, 0.5), HasSubstr("its sign is not known"));
    EXPECT_THAT(no_rise(1, std::nan("")), HasSubstr("no error"));
}

TEST(PrePeak, IsFoundWhereItIsAndNotInvented) {
    int invented = 0;
    Pull position;
    for (std::uint64_t trial = 0; trial < 50; ++trial) {
        RandomStream random(44, "pre-peak", trial);
        Spectrum data = spectrum(0.05, 0.5, 1.12, 300, &random);
        invented += find_pre_peak(data).k.has_value();
        for (std::size_t i = 0; i < data.k.size(); ++i) {
            const double u = (data.k[i] - 0.5) / 0.12;
            const double bump = 0.4 * std::exp(-0.5 * u * u);
            const double smooth = 0.05 + 0.1 * std::pow(data.k[i], 1.12);
            data.s[i] = (smooth + bump) * gamma_of_mean_one(data.dof[i], random);
        }
        const PrePeak peak = find_pre_peak(data);
        ASSERT_TRUE(peak.k.has_value()) << peak.reason;
        position.add(*peak.k);
    }
    EXPECT_EQ(invented, 0);
    // The slope of the background (0.1 at k = 0.5, against a curvature of 0.4/0.12²) shifts the
    // maximum by 0.004, smoothing by less than 0.01; shells are 0.031 apart.
    EXPECT_NEAR(position.mean(), 0.504, 0.01);
    EXPECT_LT(position.width(), 0.02);
}

}  // namespace
}  // namespace grainfield::analysis
