#include "analysis/motion/msd_result.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace grainfield::analysis {
namespace {

MsdTable table(double (*msd)(double)) {
    MsdTable t;
    for (double lag : {1.0, 2.0, 4.0, 8.0, 16.0, 32.0}) t.time.push_back(lag);
    for (auto& series : t.series) {
        series.sum.assign(16, std::vector<double>(6));
        series.pairs.assign(16, std::vector<double>(6, 10));
        for (auto& group : series.sum) {
            for (std::size_t l = 0; l < 6; ++l) group[l] = 10 * msd(t.time[l]);
        }
    }
    return t;
}

TEST(MsdResult, FitsDiffusionThroughALocalisationOffset) {
    ObservableResult result;
    add_msd(table([](double t) { return 4 * 0.3 * t + 0.02; }), result);
    EXPECT_NEAR(*result.find_measurement("d_all")->value, 0.3, 1e-12);
    EXPECT_NEAR(*result.find_measurement("d_all")->error, 0, 1e-12);
    EXPECT_FALSE(result.find_measurement("d_solid")->value.has_value());
    EXPECT_FALSE(result.find_measurement("d_solid")->reason.empty());
}

// c = 4 σ² − (4/3) D t_e with D = 0.3, σ = 0.1, t_e = 0.06.
double blurred(double t) {
    return 4 * 0.3 * (t - 0.06 / 3) + 4 * 0.01;
}

TEST(MsdResult, TellsTheLocalisationErrorFromTheOffsetAndTheExposure) {
    MsdTable t = table(blurred);
    t.exposure = 0.06;
    ObservableResult result;
    add_msd(t, result);
    EXPECT_NEAR(*result.find_measurement("localisation_all")->value, 0.1, 1e-9);
    EXPECT_EQ(result.find_measurement("exposure_all"), nullptr);
}

TEST(MsdResult, TellsTheExposureFromTheOffsetAndTheLocalisationError) {
    MsdTable t = table(blurred);
    t.localisation = 0.1;
    ObservableResult result;
    add_msd(t, result);
    EXPECT_NEAR(*result.find_measurement("exposure_all")->value, 0.06, 1e-9);
    EXPECT_EQ(result.find_measurement("localisation_all"), nullptr);
}

TEST(MsdResult, FitsNoLagThatIsShorterThanTheExposure) {
    MsdTable t = table(blurred);
    t.exposure = 1e6;
    ObservableResult result;
    add_msd(t, result);
    EXPECT_FALSE(result.find_measurement("localisation_all")->value.has_value());
    EXPECT_NE(result.find_measurement("d_all")->reason.find("the exposure"), std::string::npos);
}

TEST(MsdResult, HoldsTheOffsetWhereBothAreGiven) {
    MsdTable t = table([](double lag) { return blurred(lag) + (lag > 10 ? 0.2 : 0); });
    t.exposure = 0.06;
    t.localisation = 0.1;
    ObservableResult result;
    add_msd(t, result);
    const double d = *result.find_measurement("d_all")->value;
    EXPECT_NEAR(*result.find_measurement("offset_all")->value, 0.04 - 4.0 / 3 * d * 0.06, 1e-12);
    EXPECT_NEAR(d, 0.3, 0.01);
}

TEST(MsdResult, HasAReasonInPlaceOfANegativeSquare) {
    MsdTable t = table([](double lag) { return 4 * 0.3 * (lag - 0.5); });
    t.exposure = 0.06;
    ObservableResult result;
    add_msd(t, result);
    const Measurement* m = result.find_measurement("localisation_all");
    EXPECT_FALSE(m->value.has_value());
    EXPECT_NE(m->reason.find("below that of the exposure"), std::string::npos);
}

TEST(MsdResult, FitsTheExponentOfAPowerLaw) {
    MsdTable t = table([](double lag) { return std::pow(lag, 0.6); });
    t.has_phases = true;
    ObservableResult result;
    add_msd(t, result);
    EXPECT_NEAR(*result.find_measurement("exponent_liquid")->value, 0.6, 1e-12);
    const Curve* curve = result.find_curve("msd");
    EXPECT_EQ(curve->columns[0].values.size(), 18U);
    EXPECT_EQ(curve->text_columns.at("phase")[6], "liquid");
}

TEST(MsdResult, TakesTheGivenLocalisationErrorOutOfTheExponent) {
    MsdTable t = table([](double lag) { return std::pow(lag, 0.8) + 4 * 0.5 * 0.5; });
    ObservableResult with_offset;
    add_msd(t, with_offset);
    EXPECT_LT(*with_offset.find_measurement("exponent_all")->value, 0.75);
    t.localisation = 0.5;
    ObservableResult result;
    add_msd(t, result);
    EXPECT_NEAR(*result.find_measurement("exponent_all")->value, 0.8, 1e-12);
}

// Pairs in so many of the 16 groups only; their means differ.
ObservableResult of_groups(std::size_t groups) {
    MsdTable t = table([](double lag) { return lag; });
    for (auto& series : t.series) {
        for (std::size_t g = 0; g < 16; ++g) {
            for (double& sum : series.sum[g]) {
                sum = g < groups ? sum * (1 + 0.1 * static_cast<double>(g)) : 0;
            }
            if (g >= groups) series.pairs[g].assign(6, 0);
        }
    }
    ObservableResult result;
    add_msd(t, result);
    return result;
}

TEST(MsdResult, HasTheErrorOfTheMeanOfItsGroupsWithStudentsFactor) {
    const ObservableResult r = of_groups(5);
    // Group means 1, 1.1 … 1.4 times the lag: variance 0.025; Student's factor sqrt(4/2).
    const double share = std::sqrt(0.025 / 5) * std::sqrt(2.0);
    const Curve* curve = r.find_curve("msd");
    EXPECT_NEAR(curve->find("err")->values[2], 4 * share, 1e-12);
    EXPECT_NEAR(*r.find_measurement("d_all")->error, 0.25 * share, 1e-12);
}

TEST(MsdResult, OfThreeGroupsHasNoError) {
    const ObservableResult r = of_groups(3);
    EXPECT_TRUE(std::isnan(r.find_curve("msd")->find("err")->values[0]));
    EXPECT_FALSE(r.find_measurement("d_all")->error.has_value());
}

TEST(MsdResult, WithoutPairsIsAReason) {
    MsdTable t = table([](double) { return 0.0; });
    for (auto& series : t.series) {
        for (auto& group : series.pairs) group.assign(6, 0);
    }
    ObservableResult result;
    add_msd(t, result);
    EXPECT_EQ(result.reason, "no particle is seen in two frames");
    EXPECT_TRUE(result.curves.empty());
}

}  // namespace
}  // namespace grainfield::analysis
