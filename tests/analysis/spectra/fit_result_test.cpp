#include "analysis/spectra/fit_result.h"

#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

// S = 1 + S1 (ka)^1.12 exactly, of shells that are worth 100 independent modes each.
ObservableResult fit_of(double s1) {
    Spectrum spectrum;
    for (int i = 1; i <= 20; ++i) {
        spectrum.k.push_back(i * std::numbers::pi / 100);
        spectrum.s.push_back(1 + s1 * std::pow(spectrum.k.back(), 1.12));
        spectrum.dof.push_back(100);
        spectrum.error.push_back(0.1 * spectrum.s.back());
    }
    return fit_result(spectrum, {.k_max = 1});
}

TEST(FitResult, HasARatioWhereS1IsAboveTwoOfItsErrors) {
    const ObservableResult fit = fit_of(3);
    const Measurement s1 = *fit.find_measurement("s1");
    ASSERT_GT(*s1.value, 2 * *s1.error);
    EXPECT_NEAR(*fit.find_measurement("s0_over_s1")->value, 1.0 / 3, 1e-9);
    EXPECT_TRUE(fit.find_measurement("s0_over_s1_systematic_alpha")->value.has_value());
}

TEST(FitResult, HasAReasonInPlaceOfARatioWhereS1IsNotAboveTwoOfItsErrors) {
    for (const double s1 : {0.15, 1e-6, -0.3}) {
        const ObservableResult fit = fit_of(s1);
        ASSERT_EQ(fit.reason, "");
        const Measurement* slope = fit.find_measurement("s1");
        ASSERT_LT(*slope->value, 2 * *slope->error);
        const Measurement* ratio = fit.find_measurement("s0_over_s1");
        EXPECT_FALSE(ratio->value.has_value());
        EXPECT_NE(ratio->reason.find("S1 = "), std::string::npos) << ratio->reason;
        EXPECT_NEAR(*fit.find_measurement("s0")->value, 1, 1e-9);
        EXPECT_FALSE(fit.find_measurement("s0_over_s1_systematic_range")->value.has_value());
        EXPECT_EQ(fit.find_measurement("s0_over_s1_low"), nullptr);
    }
}

// A periodic layer of `frames` frames. Modes below `end` have amplitudes of `growth` per frame in
// the place of those of independent points.
StructureFactor growing(int frames, double end, double growth, double side = 20) {
    const Box box = square_box(side);
    RandomStream random(21, "growing");
    StructureFactor sk({.k_max = 2}, box, frames);
    for (int f = 0; f < frames; ++f) {
        StructureFactor::Sample sample =
            sk.measure(pattern(poisson_points(400, box, random), box, f));
        for (std::size_t m = 0; m < sample.rho.size(); ++m) {
            const double k = sk.grid().modes()[m].k;
            if (k < end) sample.rho[m] = {20 * k + growth * f, growth * f};
        }
        sk.add(std::move(sample));
    }
    return sk;
}

TEST(FitResult, HasNoRatioWhereSGrowsWhileTheRunLasts) {
    for (const double k_max : {1.0, 2.0}) {  // growing in the whole range, and in its lower part
        const ObservableResult fit = fit_result(growing(400, 1.2, 0.05), {.k_max = k_max});
        ASSERT_EQ(fit.reason, "");
        EXPECT_GT(*fit.find_measurement("s_growth")->value, 1.3);
        for (const char* name : {"s0_over_s1", "s0", "s1"}) {
            const Measurement* m = fit.find_measurement(name);
            ASSERT_NE(m, nullptr) << name;
            EXPECT_FALSE(m->value.has_value()) << name;
            EXPECT_NE(m->reason.find("not steady"), std::string::npos) << m->reason;
        }
        EXPECT_EQ(fit.find_curve("fit"), nullptr);
        EXPECT_NE(why_no_fit(fit).find("not steady"), std::string::npos);
    }
}

TEST(FitResult, HasNoRatioWhereSGrowsInAFewFrames) {
    const ObservableResult fit = fit_result(growing(6, 1.2, 3.5), {.k_max = 1});
    EXPECT_NE(why_no_fit(fit).find("not steady"), std::string::npos) << why_no_fit(fit);
}

TEST(FitResult, OfASteadyLayerIsAFit) {
    const ObservableResult fit = fit_result(growing(400, 1.2, 0), {.k_max = 2});
    EXPECT_EQ(why_no_fit(fit), "");
    EXPECT_NE(fit.find_curve("fit"), nullptr);
    const Measurement* growth = fit.find_measurement("s_growth");
    ASSERT_NE(growth, nullptr);
    EXPECT_NEAR(*growth->value, 1, 3 * *growth->error);
}

TEST(FitResult, TellsTheGrowthOfSWhereNoPrePeakSetsTheRange) {
    const ObservableResult steady = fit_result(growing(400, 10, 0, 40), FitOptions{});
    EXPECT_NE(why_no_fit(steady).find("--fit-k-max"), std::string::npos) << why_no_fit(steady);
    const Measurement* growth = steady.find_measurement("s_growth");
    ASSERT_NE(growth, nullptr);
    EXPECT_NEAR(growth->value.value_or(0), 1, 3 * growth->error.value_or(0));
    const ObservableResult unsteady = fit_result(growing(400, 10, 0.05, 40), FitOptions{});
    EXPECT_NE(why_no_fit(unsteady).find("not steady"), std::string::npos) << why_no_fit(unsteady);
}

// A maximum near ka = .45 and two shells below .65 of it.
TEST(FitResult, KeepsAPrePeakBelowWhichThereIsNoFit) {
    Spectrum spectrum;
    for (int i = 1; i <= 12; ++i) {
        const double k = 0.14 * i;
        spectrum.k.push_back(k);
        spectrum.s.push_back(0.2 + std::exp(-std::pow((k - 0.45) / 0.15, 2)));
        spectrum.dof.push_back(400);
        spectrum.error.push_back(0.05 * spectrum.s.back());
    }
    const ObservableResult fit = fit_result(spectrum, FitOptions{});
    ASSERT_EQ(fit.reason, "");
    const Measurement* peak = fit.find_measurement("k_pre_peak");
    ASSERT_NE(peak, nullptr);
    EXPECT_NEAR(peak->value.value_or(0), 0.45, 0.05);
    EXPECT_NE(why_no_fit(fit).find("3 are needed"), std::string::npos) << why_no_fit(fit);
    EXPECT_EQ(fit.find_curve("fit"), nullptr);
}

// Density waves about ka = 1 that grow to the end of the run, in blocks that all have the maximum.
TEST(FitResult, HasNoErrorOfAPrePeakThatIsNotSteady) {
    const Box box = square_box(40);
    RandomStream random(22, "growing pre-peak");
    StructureFactor sk({.k_max = 2}, box, 400);
    for (int f = 0; f < 400; ++f) {
        auto sample = sk.measure(pattern(poisson_points(1600, box, random), box, f));
        for (std::size_t m = 0; m < sample.rho.size(); ++m) {
            const double bump = std::exp(-std::pow((sk.grid().modes()[m].k - 1) / 0.3, 2));
            sample.rho[m] += bump * (100 + 0.5 * f);
        }
        sk.add(std::move(sample));
    }
    const ObservableResult fit = fit_result(sk, FitOptions{});
    const Measurement* peak = fit.find_measurement("k_pre_peak");
    ASSERT_NE(peak, nullptr) << fit.reason;
    EXPECT_NEAR(peak->value.value_or(0), 1, 0.1);
    EXPECT_FALSE(peak->error.has_value());
    EXPECT_NE(peak->reason.find("not steady"), std::string::npos) << peak->reason;
}

}  // namespace
}  // namespace grainfield::analysis
