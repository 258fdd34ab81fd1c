#include "analysis/spectra/fit_result.h"

#include <cmath>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

namespace grainfield::analysis {
namespace {

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

}  // namespace
}  // namespace grainfield::analysis
