#include "analysis/curve_fit.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::analysis {
namespace {

using ::testing::HasSubstr;

// S = s0 + s1 k^alpha without noise, 100 samples a shell.
ObservableResult spectrum(double s0, double s1, double alpha) {
    ObservableResult sk;
    sk.name = "sk";
    Curve curve{
        "sk", "S", {{"k", "1/l", "k", {}}, {"s", "-", "S", {}}, {"s_err", "-", "e", {}}}, {}};
    Curve samples{"sk_samples", "n", {{"dof", "-", "dof", {}}}, {}};
    for (int i = 1; i <= 40; ++i) {
        const double k = 0.025 * i;
        const double s = s0 + s1 * std::pow(k, alpha);
        curve.columns[0].values.push_back(k);
        curve.columns[1].values.push_back(s);
        curve.columns[2].values.push_back(0.1 * s);
        samples.columns[0].values.push_back(100);
    }
    sk.curves = {curve, samples};
    return sk;
}

TEST(CurveFit, FindsS0AndS1OfASpectrumWithoutNoise) {
    FitOptions options;
    options.k_max = 0.6;
    const ObservableResult fit = curve_fit(spectrum(0.5, 2, 1.12), options);
    EXPECT_EQ(fit.reason, "");
    EXPECT_NEAR(*fit.find_measurement("s0")->value, 0.5, 1e-6);
    EXPECT_NEAR(*fit.find_measurement("s1")->value, 2, 1e-6);
    EXPECT_NEAR(*fit.find_measurement("s0_over_s1")->value, 0.25, 1e-6);
    EXPECT_GT(*fit.find_measurement("s0_over_s1")->error, 0);
    EXPECT_LT(*fit.find_measurement("s0_over_s1_low")->value, 0.25);
    EXPECT_GT(*fit.find_measurement("s0_over_s1_high")->value, 0.25);
    EXPECT_DOUBLE_EQ(*fit.find_measurement("k_fit")->value, 0.6);
    EXPECT_FALSE(fit.find_measurement("alpha")->error.has_value()) << "fixed";
    EXPECT_EQ(fit.curves[0].columns[0].unit, "1/l");
}

TEST(CurveFit, FitsAFreeExponent) {
    FitOptions options;
    options.k_max = 0.6;
    options.exponent = Exponent::free;
    const ObservableResult fit = curve_fit(spectrum(0.5, 2, 1.58), options);
    EXPECT_NEAR(*fit.find_measurement("alpha")->value, 1.58, 1e-3);
    EXPECT_TRUE(fit.find_measurement("alpha")->error.has_value());
}

TEST(CurveFit, SaysWhyThereIsNone) {
    FitOptions options;
    EXPECT_THAT(curve_fit(spectrum(0.5, 2, 1.12), options).reason, HasSubstr("fit.k-max"))
        << "S that only grows has no pre-peak";
    options.k_max = 0.6;
    ObservableResult without = spectrum(0.5, 2, 1.12);
    without.curves.pop_back();
    EXPECT_THAT(curve_fit(without, options).reason, HasSubstr("samples"));
    without.reason = "no fields";
    EXPECT_EQ(curve_fit(without, options).reason, "no fields");
    options.k_max = 0.03;
    EXPECT_NE(curve_fit(spectrum(0.5, 2, 1.12), options).reason, "") << "one shell";
}

}  // namespace
}  // namespace grainfield::analysis
