#include "analysis/density/synthetic_result.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/density/synthetic_variance.h"
#include "analysis/spectra/spectrum_model.h"
#include "core/errors.h"
#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

using ::testing::HasSubstr;

// S = 0.05 + (ka)^1.12 up to 0.4/a, a plateau above; measured on π/L of a box of 60 a.
SyntheticInput input(bool has_fit = true, double s0 = 0.05, double error = 0.01) {
    SyntheticInput in;
    for (int n = 1; n < 30; ++n) {
        const double k = std::numbers::pi / 60 * n;
        in.spectrum.k.push_back(k);
        in.spectrum.s.push_back(s0 + std::pow(std::min(k, 0.4), 1.12));
        in.spectrum.dof.push_back(200.0 * n);
        in.spectrum.error.push_back(in.spectrum.s.back() / std::sqrt(200.0 * n));
    }
    in.density = 1.1;
    in.side = 60;
    in.fit.name = "fit";
    if (has_fit) {
        in.fit.measurements = {{"s0_over_s1", "-", s0, error, 500, ""},
                               {"s0", "-", s0, error, 500, ""},
                               {"s1", "-", 1, 0.03, 500, ""},
                               {"alpha", "-", 1.12, std::nullopt, 0, "given"},
                               {"k_fit", "1/a", 0.3, std::nullopt, 0, "end"},
                               {"s0_s1_correlation", "-", -0.8, std::nullopt, 0, ""}};
    } else {
        in.fit.reason = "no pre-peak";
    }
    return in;
}

std::vector<double> of_side(const Curve& curve, const char* column, const std::string& side) {
    std::vector<double> values;
    for (std::size_t i = 0; i < curve.find(column)->values.size(); ++i) {
        if (curve.text_columns.at("side")[i] == side) {
            values.push_back(curve.find(column)->values[i]);
        }
    }
    return values;
}

TEST(SyntheticResult, HasTheMeasuredBoxTenTimesItAndAnInfiniteOne) {
    const ObservableResult r = synthetic_result(input(), {});
    ASSERT_EQ(r.curves.size(), 1U);
    for (const char* side : {"60", "600", "inf"}) {
        const auto l = of_side(r.curves[0], "l", side);
        const auto variance = of_side(r.curves[0], "variance", side);
        const auto error = of_side(r.curves[0], "err", side);
        const auto beyond = of_side(r.curves[0], "beyond", side);
        ASSERT_GT(l.size(), 20U) << side;
        for (std::size_t i = 0; i + 1 < l.size(); ++i) {
            EXPECT_GT(variance[i], 0);
            EXPECT_GE(error[i], std::abs(beyond[i])) << "what is assumed is not known";
            if (beyond[i] < 0.2 * variance[i]) {
                EXPECT_LT(error[i], 0.5 * variance[i]);
            }
        }
    }
    EXPECT_NEAR(of_side(r.curves[0], "variance", "60").back(), 0, 1e-9);
    EXPECT_NEAR(of_side(r.curves[0], "variance", "600").back(), 0, 1e-7);
    // Small windows do not know the box.
    EXPECT_NEAR(of_side(r.curves[0], "variance", "60")[0],
                of_side(r.curves[0], "variance", "inf")[0], 2e-3);
}

// White noise of strength one half: σ² = ½ ℓ² for every window, also beyond the shells.
TEST(SyntheticResult, AFieldKeepsItsLastValueBeyondTheShells) {
    const Spectrum flat{{0.1, 0.5, 1, 2}, {0.5, 0.5, 0.5, 0.5}, {100, 100, 100, 100}, {0, 0, 0, 0}};
    const SpectrumModel model =
        SpectrumModel::of_measured(flat, std::nullopt, SpectrumModel::Tail::constant);
    const auto values = synthetic_variance(model, 1, {1.0, 10.0});
    EXPECT_NEAR(values[0].variance, 0.5, 1e-4);
    EXPECT_NEAR(values[1].variance, 50, 1e-2);
    const SpectrumModel line = SpectrumModel::of_fit(
        {.s0 = 1.3, .s1 = 0.1, .alpha = 1, .k_end = 0.5}, SpectrumModel::Tail::constant);
    EXPECT_DOUBLE_EQ(line.value(0.7), 1.35);
}

TEST(SyntheticResult, SaysWhereTheCrossoverLies) {
    const Measurement m = *synthetic_result(input(), {}).find_measurement("crossover_length");
    EXPECT_NEAR(*m.value, 2 * std::numbers::pi * std::pow(0.05, -1 / 1.12), 1e-9);
    EXPECT_NEAR(*m.error, *m.value * 0.2 / 1.12, 1e-9);
    const Measurement unsure =
        *synthetic_result(input(true, 0.01, 0.02), {}).find_measurement("crossover_length");
    EXPECT_TRUE(unsure.value && !unsure.error);
    EXPECT_THAT(unsure.reason, HasSubstr("above"));
    const Measurement none =
        *synthetic_result(input(true, -0.01, 0.02), {}).find_measurement("crossover_length");
    EXPECT_FALSE(none.value);
    EXPECT_THAT(none.reason, HasSubstr("not positive"));
}

// NaN in place of the error: std::max(0.0, NaN) is 0, a variance that is known exactly.
TEST(SyntheticResult, HasNoErrorWhereTheFitHasNone) {
    SyntheticInput in = input();
    in.fit.measurements[1].error.reset();  // of S0
    const ObservableResult r = synthetic_result(in, {});
    const auto variance = of_side(r.curves[0], "variance", "inf");
    const auto error = of_side(r.curves[0], "err", "inf");
    ASSERT_GT(error.size(), 20U);
    for (std::size_t i = 0; i < error.size(); ++i) {
        EXPECT_GT(variance[i], 0);
        EXPECT_TRUE(std::isnan(error[i]));
    }
}

TEST(SyntheticResult, TakesAShellWithoutAnErrorAsSoManyModes) {
    Spectrum spectrum = input().spectrum;
    const SpectrumModel whole = SpectrumModel::of_measured(spectrum, std::nullopt);
    spectrum.error.clear();
    const SpectrumModel none = SpectrumModel::of_measured(spectrum, std::nullopt);
    const std::vector<double> jacobian(whole.size(), 1.0);
    EXPECT_GT(none.variance(jacobian), 0);
    EXPECT_NEAR(none.variance(jacobian) / whole.variance(jacobian), 1, 1e-12);
}

TEST(SyntheticResult, CrossoverOfAFittedExponentWithoutAnErrorHasNone) {
    SyntheticInput in = input();
    in.fit.options = {{"exponent", OptionValue(std::string("free"))}};
    const Measurement m = *synthetic_result(in, {}).find_measurement("crossover_length");
    EXPECT_TRUE(m.value && !m.error);
    EXPECT_THAT(m.reason, HasSubstr("exponent"));
}

TEST(SyntheticResult, WithoutAFitKnowsNoLargerBoxThanTheMeasuredOne) {
    const ObservableResult r = synthetic_result(input(false), {});
    ASSERT_EQ(r.curves.size(), 1U);
    EXPECT_FALSE(of_side(r.curves[0], "l", "60").empty());
    EXPECT_TRUE(of_side(r.curves[0], "l", "600").empty());
    for (const char* name : {"box_600", "box_inf", "crossover_length"}) {
        EXPECT_THAT(r.find_measurement(name)->reason, HasSubstr("no pre-peak")) << name;
    }
    const ObservableResult of_fit =
        synthetic_result(input(false), {.spectrum = SpectrumSource::fit});
    EXPECT_EQ(of_fit.reason, "no pre-peak");
    EXPECT_TRUE(of_fit.curves.empty());
}

TEST(SyntheticResult, HasTheReasonOfAFitThatOnlyLacksItsNumbers) {
    SyntheticInput in = input(false);
    in.fit.reason.clear();
    for (const char* name : {"s0_over_s1", "s0", "s1"}) {
        in.fit.measurements.push_back(missing(name, "-", "S is not steady"));
    }
    in.fit.measurements.push_back({"k_pre_peak", "1/a", 0.4, 0.01, 100, ""});
    const ObservableResult r = synthetic_result(in, {});
    for (const char* name : {"box_600", "box_inf", "crossover_length"}) {
        EXPECT_THAT(r.find_measurement(name)->reason, HasSubstr("not steady")) << name;
    }
    EXPECT_EQ(synthetic_result(in, {.spectrum = SpectrumSource::fit}).reason, "S is not steady");
}

TEST(SyntheticResult, RefusesSidesThatAreNone) {
    SyntheticOptions options;
    for (const char* sides : {"100,x", "-3", "0", "nan", "100;200"}) {
        EXPECT_THROW(describe(options).set("sides", std::string(sides)), OptionError) << sides;
    }
    for (const double side : {-3.0, 0.0, std::nan("")}) {
        EXPECT_THROW(synthetic_result(input(), {.sides = std::vector{100, side}}), OptionError);
    }
    describe(options).set("sides", std::string(" 80 ,inf"));
    const ObservableResult r = synthetic_result(input(), options);
    EXPECT_FALSE(of_side(r.curves[0], "l", "80").empty());
    // Too many wavevectors: a reason, not an hour.
    const ObservableResult huge = synthetic_result(input(), {.sides = std::vector{1e6}});
    EXPECT_THAT(huge.find_measurement("box_1e+06")->reason, HasSubstr("too long"));
}

// Linear propagation against 4000 draws of the parameters: a standard deviation is known to 1.1 %,
// 8 % is seven of its standard errors.
TEST(SyntheticResult, HasTheErrorThatDrawsOfTheParametersShow) {
    const SyntheticInput in = input();
    const SpectrumModel::Line line{0.05, 1, 1.12, 0.01, 0.03, -0.8, 0.3};
    const std::vector<double> windows{3, 30};
    const auto central =
        synthetic_variance(SpectrumModel::of_measured(in.spectrum, line), 1.1, 60, windows);
    std::vector<double> squares(windows.size(), 0.0);
    const int draws = 4000;
    for (int d = 0; d < draws; ++d) {
        RandomStream random(5, "draws", static_cast<std::uint64_t>(d));
        Spectrum spectrum = in.spectrum;
        for (std::size_t i = 0; i < spectrum.s.size(); ++i) {
            spectrum.s[i] += spectrum.error[i] * random.normal();
        }
        SpectrumModel::Line drawn = line;
        const double first = random.normal();
        drawn.s0 += 0.01 * first;
        drawn.s1 += 0.03 * (-0.8 * first + 0.6 * random.normal());
        const auto values =
            synthetic_variance(SpectrumModel::of_measured(spectrum, drawn), 1.1, 60, windows);
        for (std::size_t i = 0; i < windows.size(); ++i) {
            squares[i] += std::pow(values[i].variance - central[i].variance, 2) / draws;
        }
    }
    for (std::size_t i = 0; i < windows.size(); ++i) {
        EXPECT_NEAR(std::sqrt(squares[i]), central[i].error, 0.08 * central[i].error) << windows[i];
    }
}

}  // namespace
}  // namespace grainfield::analysis
