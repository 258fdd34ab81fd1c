#include "report/page/differences.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::Contains;
using testing::HasSubstr;

Results run_of(Origin origin, double s0, double error, double gamma = 4.5) {
    Results run;
    run.source.origin = origin;
    run.record.version = "0.1.0";
    run.identity = {
        .origin = origin,
        .control = ControlValue{.parameter = ControlParameter::acceleration, .value = gamma}};
    ObservableResult fit;
    fit.name = "fit";
    fit.measurements = {{"s0", "-", s0, error, 10, ""}, {"k_fit", "1/a", 0.3, std::nullopt, 0, ""}};
    run.observables = {fit};
    return run;
}

TEST(Differences, AreInUnitsOfBothErrorsTogether) {
    const std::vector<Results> runs{run_of(Origin::video, 0.5, 0.03),
                                    run_of(Origin::rendered, 0.3, 0.04)};
    const auto table = differences(runs, {"tracked", "true"}, identities_of(runs),
                                   {{"fit", "Fit of S(k)", {{"s0", "S₀"}}}});
    ASSERT_TRUE(table.has_value());
    ASSERT_EQ(table->rows.size(), 1U) << "k_fit has no error";
    EXPECT_EQ(table->rows[0].name, "Fit of S(k): S₀");
    EXPECT_NEAR(table->rows[0].cells[0].value, 4, 1e-12);
    EXPECT_EQ(table->rows[0].cells[0].text, "+4.0");
    EXPECT_TRUE(table->rows[0].cells[0].failed);
    EXPECT_EQ(table->columns[0].label, "tracked less true");
}

Results spectrum_of(Origin origin, std::vector<double> k, std::vector<double> s) {
    Results run = run_of(origin, 0.5, 0.03);
    run.box = Box{{}, {50, 50}, {Boundary::periodic, Boundary::periodic}};
    ObservableResult sk;
    sk.name = "sk";
    const std::vector<double> errors(k.size(), 0.01);
    const std::vector<double> modes(k.size(), 4);
    sk.curves = {{"sk",
                  "Structure factor",
                  {{"k", "1/a", "k", std::move(k)},
                   {"s", "-", "S", std::move(s)},
                   {"s_err", "-", "error", errors},
                   {"n", "-", "modes", modes}},
                  {}}};
    run.observables.push_back(sk);
    return run;
}

// Nine shells that both have; the tenth of each is alone. Differences are 2 errors of one run, so
// that the root mean square is 2/√2.
TEST(Differences, OfSpectraAreTheRootMeanSquareOverTheSharedShells) {
    std::vector<double> k{0.05};
    std::vector<double> other_k;
    for (int i = 1; i < 10; ++i) k.push_back(0.1 * i);
    other_k.assign(k.begin() + 1, k.end());
    other_k.push_back(1.05);
    std::vector<double> s(k.size(), 0.4);
    std::vector<double> other_s(k.size(), 0.42);
    s.front() = 9;
    other_s.back() = 9;
    std::vector<Results> runs{spectrum_of(Origin::video, k, s),
                              spectrum_of(Origin::rendered, other_k, other_s)};
    auto table = differences(runs, {"A", "B"}, identities_of(runs), {});
    ASSERT_TRUE(table.has_value());
    ASSERT_EQ(table->rows.size(), 2U);
    EXPECT_EQ(table->rows[1].name, "Structure factor: root mean square");
    EXPECT_NEAR(table->rows[1].cells[0].value, std::sqrt(2), 1e-9);
    EXPECT_EQ(table->rows[1].cells[0].text, "1.4 (9 shells)");
    EXPECT_FALSE(table->rows[1].cells[0].failed) << "2 is below 1 + 3 √(2/9) = 2.41";
    EXPECT_THAT(table->note, HasSubstr("over the n shells of k"));

    runs[1] = spectrum_of(Origin::rendered, other_k, std::vector<double>(k.size(), 0.4225));
    table = differences(runs, {"A", "B"}, identities_of(runs), {});
    EXPECT_NEAR(table->rows[1].cells[0].value, 2.25 / std::sqrt(2), 1e-9);
    EXPECT_TRUE(table->rows[1].cells[0].failed) << "2.53 is above 2.41";

    runs[0].observables[1].curves[0].columns[2].values[3] = std::numeric_limits<double>::infinity();
    table = differences(runs, {"A", "B"}, identities_of(runs), {});
    EXPECT_EQ(table->rows[1].cells[0].text, "1.6 (8 of 9 shells)") << "one has no error";
}

TEST(Differences, OfSpectraAreNotThoseOfOverlappingWavesOrOtherEstimators) {
    std::vector<double> many;
    for (int i = 1; i < 20; ++i) many.push_back(0.1 * i);
    std::vector<Results> runs{spectrum_of(Origin::video, many, many),
                              spectrum_of(Origin::rendered, many, many)};
    const auto rows = [&] {
        return differences(runs, {"A", "B"}, identities_of(runs), {})->rows.size();
    };
    EXPECT_EQ(rows(), 2U);
    runs[1].observables[1].curves[0].title = "Structure factor, connected";
    EXPECT_EQ(rows(), 1U) << "measured in another way";
    runs[1].observables[1].curves[0].title = "Structure factor";
    for (Results& run : runs) run.box.boundary = {Boundary::walls, Boundary::walls};
    EXPECT_EQ(rows(), 1U) << "plane waves between walls overlap";
    for (Results& run : runs) run.observables[1].curves[0].name = "sk_neumann";
    EXPECT_EQ(rows(), 2U) << "modes between walls do not";
}

TEST(Differences, OfFewShellsOrWithoutErrorsAreNoRow) {
    const std::vector<double> few{0.1, 0.2, 0.3};
    std::vector<Results> runs{spectrum_of(Origin::video, few, few),
                              spectrum_of(Origin::rendered, few, few)};
    auto table = differences(runs, {"A", "B"}, identities_of(runs), {});
    ASSERT_TRUE(table.has_value());
    EXPECT_EQ(table->rows.size(), 1U);
    EXPECT_THAT(table->note, testing::Not(HasSubstr("shells")));
    std::vector<double> many;
    for (int i = 1; i < 20; ++i) many.push_back(0.1 * i);
    runs = {spectrum_of(Origin::video, many, many), spectrum_of(Origin::rendered, many, many)};
    for (double& error : runs[1].observables[1].curves[0].columns[2].values) {
        error = std::numeric_limits<double>::quiet_NaN();
    }
    table = differences(runs, {"A", "B"}, identities_of(runs), {});
    EXPECT_EQ(table->rows.size(), 1U);
}

TEST(Differences, PairRunsThatDifferInOriginOnly) {
    const std::vector<Results> runs{run_of(Origin::video, 1, 1, 4), run_of(Origin::video, 1, 1, 5),
                                    run_of(Origin::rendered, 1, 1, 5),
                                    run_of(Origin::rendered, 1, 1, 6)};
    const auto pairs = pairs_of(runs, identities_of(runs));
    ASSERT_EQ(pairs.size(), 1U);
    EXPECT_EQ(pairs[0].first, 1U);
    EXPECT_EQ(pairs[0].second, 2U);
}

TEST(Differences, LeaveOutRunsOfAnotherFrameRate) {
    std::vector<Results> runs{run_of(Origin::video, 1, 1), run_of(Origin::rendered, 1, 1),
                              run_of(Origin::rendered, 1, 1)};
    runs[0].source.frame_rate = 10;
    runs[1].source.frame_rate = 500;
    runs[2].source.frame_rate = 10.0004;
    const auto pairs = pairs_of(runs, identities_of(runs));
    ASSERT_EQ(pairs.size(), 1U);
    EXPECT_EQ(pairs[0].second, 2U);
}

TEST(Differences, DoNotPairFieldsOfOtherModels) {
    std::vector<RunIdentity> identities(3);
    for (RunIdentity& identity : identities) {
        identity.origin = Origin::field;
        identity.control =
            ControlValue{.parameter = ControlParameter::critical_distance, .value = 0.01};
        identity.gradient_order = 4;
    }
    identities[0].gradient_order = 2;
    identities[0].dimension = identities[1].dimension = 1;
    EXPECT_TRUE(pairs_of(std::vector<Results>(3), identities).empty());
}

TEST(Differences, AreNotThereWithoutCommonNumbers) {
    const std::vector<Results> runs{run_of(Origin::video, 0.5, 0), run_of(Origin::md, 0.3, 0.1)};
    EXPECT_FALSE(differences(runs, {"A", "B"}, identities_of(runs), {}).has_value());
}

TEST(Mismatches, NameVersionsUnitsDimensionsAndMissingErrors) {
    std::vector<Results> runs{run_of(Origin::video, 1, 1), run_of(Origin::md, 1, 0)};
    runs[1].record.version = "0.2.0";
    runs.push_back(run_of(Origin::points, 1, 1));
    runs[2].identity = {.origin = Origin::field, .dimension = 1};
    runs[0].source.time_unit = TimeUnit::second;
    runs[1].source.time_unit = TimeUnit::sqrt_a_over_g;
    for (const std::size_t r : {0U, 1U}) {
        runs[r].observables.emplace_back().measurements = {
            {"d", "a^2/time unit", 1, std::nullopt, 1, ""}};
    }
    const auto texts = mismatches(runs, {"A", "B", "C"}, identities_of(runs));
    EXPECT_THAT(texts,
                Contains(HasSubstr("versions of the program: 0.1.0 (A and 1 more), 0.2.0 (B)")));
    EXPECT_THAT(texts, Contains(HasSubstr("lengths in different units")));
    EXPECT_THAT(texts,
                Contains(AllOf(HasSubstr("times in different units"), HasSubstr("--sphere-mm"))));
    EXPECT_THAT(texts, Contains(HasSubstr("1 dimension (C), 2 dimensions (A and 1 more)")));
    EXPECT_THAT(texts,
                Contains(HasSubstr("without any error, so that differences cannot be judged: B")));
}

TEST(Mismatches, OfTimesMatterOnlyWhereAUnitHasTimeInIt) {
    std::vector<Results> runs{run_of(Origin::video, 1, 1), run_of(Origin::rendered, 1, 1)};
    runs[0].source.time_unit = TimeUnit::second;
    runs[1].source.time_unit = TimeUnit::sqrt_a_over_g;
    EXPECT_TRUE(mismatches(runs, {"A", "B"}, identities_of(runs)).empty());
    for (Results& run : runs) {
        run.observables.emplace_back().curves = {
            {"own", "", {{"when", "time unit", "Time", {}}}, {}}};
    }
    EXPECT_THAT(mismatches(runs, {"A", "B"}, identities_of(runs)),
                Contains(HasSubstr("times in different units: s (A), √(a/g) (B)")));
}

TEST(Mismatches, OfFramesAndTimeUnitsNameBothOptionsAtOnce) {
    std::vector<Results> runs{run_of(Origin::video, 1, 1), run_of(Origin::rendered, 1, 1)};
    runs[0].source.time_unit = TimeUnit::frame;
    runs[1].source.time_unit = TimeUnit::sqrt_a_over_g;
    for (Results& run : runs) {
        run.observables.emplace_back().curves = {
            {"own", "", {{"when", "time unit", "Time", {}}}, {}}};
    }
    EXPECT_THAT(time_mismatch(runs, {"A", "B"}),
                AllOf(HasSubstr("--fps"), HasSubstr("--sphere-mm")));
}

TEST(Mismatches, AreNoneBetweenLikeRuns) {
    const std::vector<Results> runs{run_of(Origin::video, 1, 1), run_of(Origin::rendered, 1, 1)};
    EXPECT_TRUE(mismatches(runs, {"A", "B"}, identities_of(runs)).empty());
}

}  // namespace
}  // namespace grainfield::report
