#include "report/diffusion.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/possible_numbers.h"

namespace grainfield::report {
namespace {

using testing::HasSubstr;

ObservableResult with_exponent(double exponent, double error) {
    ObservableResult msd;
    msd.name = "msd";
    msd.measurements = {{"d_liquid", "a^2/time unit", 1, 0.01, 9, ""},
                        {"exponent_liquid", "-", exponent, error, 9, ""},
                        {"d_all", "a^2/time unit", 2, 0.01, 9, ""}};
    return msd;
}

// An MSD of one decade, its exponent with all that is in it, and a line through its ends.
ObservableResult of_curve(double (*function)(double), double exponent) {
    ObservableResult msd = with_exponent(exponent, 0.01);
    Curve curve{"msd", "", {{"t", "time unit", "", {}}, {"msd", "a^2", "", {}}}, {}};
    for (int i = 0; i <= 12; ++i) {
        const double t = std::pow(10.0, i / 12.0);
        curve.columns[0].values.push_back(t);
        curve.columns[1].values.push_back(function(t));
        curve.text_columns["phase"].push_back("liquid");
    }
    const double slope = (function(10) - function(1)) / 9;
    const double offset = function(1) - slope;
    msd.measurements.push_back({"offset_liquid", "a^2", offset, 0.01, 9, ""});
    Curve line{"msd_fit",
               "",
               {{"t", "time unit", "", {1, 10}}, {"msd", "a^2", "", {function(1), function(10)}}},
               {{"phase", {"liquid", "liquid"}}}};
    msd.curves = {curve, line};
    return msd;
}

TEST(Diffusion, IsWhatMeetsOneWithinATenthAndTheErrorFromBothSides) {
    EXPECT_TRUE(judge_diffusion(with_exponent(1.0, 0.01), "liquid").is_diffusion);
    EXPECT_TRUE(judge_diffusion(with_exponent(1.13, 0.05), "liquid").is_diffusion);
    EXPECT_TRUE(judge_diffusion(with_exponent(0.87, 0.05), "liquid").is_diffusion);
    const DiffusionVerdict flight = judge_diffusion(with_exponent(1.3, 0.01), "liquid");
    EXPECT_FALSE(flight.is_diffusion);
    EXPECT_EQ(flight.words, "the MSD grows as t^1.30 (± 0.01): flight, not yet diffusion");
    const DiffusionVerdict cage = judge_diffusion(with_exponent(0.5, 0.01), "liquid");
    EXPECT_FALSE(cage.is_diffusion);
    EXPECT_THAT(cage.words, HasSubstr("cage"));
    EXPECT_TRUE(judge_diffusion(with_exponent(1.3, 0.01), "solid").is_diffusion) << "no exponent";
}

TEST(Diffusion, WithAnOffsetIsToldFromACageByTheSlopeOfTheMsd) {
    const ObservableResult offset = of_curve([](double t) { return t + 2; }, 0.7);
    EXPECT_TRUE(judge_diffusion(offset, "liquid").is_diffusion);
    EXPECT_EQ(judge_diffusion(offset, "liquid").words, "offset not removed");
    const ObservableResult cage = of_curve([](double t) { return std::sqrt(t); }, 0.5);
    EXPECT_FALSE(judge_diffusion(cage, "liquid").is_diffusion) << "its line has an offset, too";
}

TEST(Diffusion, WithALocalisationErrorGivenHasNoOffsetToBlame) {
    ObservableResult msd = of_curve([](double t) { return t + 2; }, 0.7);
    msd.options = {{"localisation", 0.1}};
    EXPECT_FALSE(judge_diffusion(msd, "liquid").is_diffusion);
    msd.options = {{"localisation", std::string(automatic)}};
    EXPECT_TRUE(judge_diffusion(msd, "liquid").is_diffusion);
}

TEST(PossibleNumbers, HaveNoDiffusionOfACage) {
    Results run;
    run.frames = 100;
    run.observables = {of_curve([](double t) { return std::sqrt(t); }, 0.5)};
    run = with_possible_numbers(run);
    const ObservableResult& msd = run.observables.front();
    EXPECT_FALSE(msd.find_measurement("d_liquid")->value);
    EXPECT_THAT(msd.find_measurement("d_liquid")->reason, HasSubstr("cage"));
    EXPECT_TRUE(msd.find_curve("msd_fit")->columns[0].values.empty());
    EXPECT_TRUE(msd.find_measurement("d_all")->value) << "another phase";
}

}  // namespace
}  // namespace grainfield::report
