#include "report/figures/scaled_spectrum.h"

#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;

Curve spectrum(const std::string& name, std::vector<double> s, std::vector<double> error) {
    return {name,
            "S(k)",
            {{"k", "1/a", "Wavevector", {0.1, 0.2}},
             {"s", "-", "S(k)", std::move(s)},
             {"s_err", "-", "Error", std::move(error)}},
            {}};
}

Results run_with(double s1, bool walls) {
    Results run;
    ObservableResult sk;
    sk.name = "sk";
    sk.curves = {spectrum("sk", {8, 16}, {2, 4})};
    if (walls) sk.curves.push_back(spectrum("sk_neumann", {4, 6}, {1, 1}));
    ObservableResult fit;
    fit.name = "fit";
    fit.measurements = {{"s1", "-", s1, 0.1, 10, ""}};
    fit.curves = {spectrum("fit", {4, 5}, {0.5, 0.5})};
    run.observables = {sk, fit};
    return run;
}

TEST(ScaledSpectrum, IsTheFittedSpectrumAndTheFitOverS1) {
    const Figure figure = scaled_spectrum({run_with(2, false), run_with(2, true)}, {"A", "B"});
    ASSERT_EQ(figure.series.size(), 4U);
    EXPECT_EQ(figure.series[0].y, (std::vector<double>{4, 8}));
    EXPECT_EQ(figure.series[0].error, (std::vector<double>{1, 2}));
    EXPECT_EQ(figure.series[1].y, (std::vector<double>{2, 2.5}));
    EXPECT_EQ(figure.series[2].y, (std::vector<double>{2, 3})) << "modes between the walls";
    EXPECT_TRUE(figure.absent.empty());
}

TEST(ScaledSpectrum, LeavesOutRunsWithoutASlopeAndSaysWhy) {
    Results failed = run_with(1, false);
    failed.observables[1].measurements.clear();
    failed.observables[1].reason = "no pre-peak";
    Results none;
    const Figure figure =
        scaled_spectrum({run_with(-1, false), failed, none}, {"falls", "failed", "none"});
    EXPECT_TRUE(figure.series.empty());
    ASSERT_EQ(figure.absent.size(), 3U);
    EXPECT_THAT(figure.absent[0].reason, HasSubstr("does not grow"));
    EXPECT_EQ(figure.absent[1].reason, "no pre-peak");
    EXPECT_THAT(figure.absent[2].reason, HasSubstr("no fit"));
}

// S1 is above one of its errors and below two.
TEST(ScaledSpectrum, LeavesOutRunsWithoutAnS0OverS1AsTheAnalysisDoes) {
    Results run = run_with(0.15, false);
    run.observables[1].measurements.push_back(
        {"s0_over_s1", "-", std::nullopt, std::nullopt, 0, "S is not known to grow with k"});
    const Figure figure = scaled_spectrum({run}, {"A"});
    EXPECT_TRUE(figure.series.empty());
    ASSERT_EQ(figure.absent.size(), 1U);
    EXPECT_EQ(figure.absent[0].reason, "S is not known to grow with k");
    for (Measurement& m : run.observables[1].measurements) {
        m = {m.name, "-", std::nullopt, std::nullopt, 0, "S is not steady"};
    }
    EXPECT_EQ(scaled_spectrum({run}, {"A"}).absent[0].reason, "S is not steady");
}

}  // namespace
}  // namespace grainfield::report
