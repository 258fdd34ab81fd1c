#include "report/possible_numbers.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

using testing::HasSubstr;

const Measurement& number(const Results& run, const char* observable, const char* name) {
    return *run.find(observable)->find_measurement(name);
}

TEST(PossibleNumbers, OfOneFrameHaveNoPhasesAndNoSAtLongWaves) {
    const Results run = with_possible_numbers(sample::results({1, 120, 40, false, "A"}));
    for (const auto& [observable, name] :
         {std::pair{"phase", "solid_fraction"}, std::pair{"sk", "s_lowest_k"}}) {
        EXPECT_FALSE(number(run, observable, name).value) << name;
        EXPECT_FALSE(number(run, observable, name).error) << name;
        EXPECT_THAT(number(run, observable, name).reason, HasSubstr("one frame"));
    }
    EXPECT_TRUE(number(run, "sk", "lowest_k").value) << "fixed by the box";
    EXPECT_TRUE(number(run, "q4", "lattice_spacing").value);
}

TEST(PossibleNumbers, OfAFilmStayAsTheyAre) {
    const Results run = with_possible_numbers(sample::results({1, 120, 40, true, "A"}));
    EXPECT_TRUE(number(run, "phase", "solid_fraction").value);
    EXPECT_TRUE(number(run, "sk", "s_lowest_k").value);
    EXPECT_TRUE(number(run, "msd", "d_liquid").value);
}

// Two boxes: one known but for its smallest window, one with errors as large as its values.
TEST(PossibleNumbers, HaveNoVarianceOfOtherBoxesWhoseErrorsHideIt) {
    Results run = sample::results({1, 120, 40, true, "A"});
    const auto boxes = [&run](std::vector<double> errors, std::vector<double> beyond) {
        std::erase_if(run.observables, [](const auto& o) { return o.name == "synthetic"; });
        ObservableResult synthetic;
        synthetic.name = "synthetic";
        synthetic.curves = {{"synthetic",
                             "",
                             {{"l", "a", "", {1, 2, 4, 1, 2, 4}},
                              {"variance", "-", "", {1, 1, 1, 1, 1, 1}},
                              {"err", "-", "", std::move(errors)},
                              {"beyond", "-", "", std::move(beyond)}},
                             {{"side", {"50", "50", "50", "500", "500", "500"}}}}};
        run.observables.push_back(synthetic);
    };
    boxes({0.6, 0.1, 0.1, 1, 1, 0.2}, {0, 0, 0, 0, 0, 0});
    const ObservableResult some = *with_possible_numbers(run).find("synthetic");
    ASSERT_EQ(some.curves.size(), 1U);
    EXPECT_THAT(some.curves[0].columns[0].values, testing::ElementsAre(2, 4));
    EXPECT_THAT(some.curves[0].text_columns.at("side"), testing::ElementsAre("50", "50"));
    EXPECT_THAT(some.find_measurement("box_500")->reason, HasSubstr("too short"));
    EXPECT_EQ(some.find_measurement("box_50"), nullptr);
    boxes({1, 1, 1, 1, 1, 1}, {1, 1, 1, 1, 1, 1});
    const ObservableResult none = *with_possible_numbers(run).find("synthetic");
    EXPECT_TRUE(none.curves.empty()) << "no panel of error bars";
    EXPECT_THAT(none.find_measurement("box_50")->reason, HasSubstr("sk.k-max"));
}

TEST(PossibleNumbers, HaveNoAveragingTimeLongerThanTheFilm) {
    Results run = sample::results({1, 120, 40, true, "A"});
    run.frames = 31;
    run.source.frame_rate = 500;
    for (ObservableResult& observable : run.observables) {
        if (observable.name != "phase") continue;
        observable.measurements = {{"averaging_time", "time unit", 0.4, std::nullopt, 0, ""}};
    }
    EXPECT_FALSE(number(with_possible_numbers(run), "phase", "averaging_time").value);
    run.frames = 201;
    EXPECT_TRUE(number(with_possible_numbers(run), "phase", "averaging_time").value);
}

TEST(PossibleNumbers, KnowTheLengthOfAFilmOfWhichOneFrameInTenWasTaken) {
    Results run = sample::results({1, 120, 40, true, "A"});
    run.frames = 31;
    run.source.frame_rate = 500;
    EXPECT_NEAR(length_of_film(run), 0.062, 1e-12) << "an old file";
    run.observables.push_back({"lengths",
                               {{"film_length", "time unit", 0.62, std::nullopt, 0, ""},
                                {"frame_interval", "time unit", 0.02, std::nullopt, 0, ""}},
                               {},
                               {},
                               "",
                               0});
    EXPECT_NEAR(length_of_film(run), 0.62, 1e-12);
    for (ObservableResult& observable : run.observables) {
        if (observable.name != "phase") continue;
        observable.measurements = {{"averaging_time", "time unit", 0.4, std::nullopt, 0, ""}};
    }
    EXPECT_TRUE(number(with_possible_numbers(run), "phase", "averaging_time").value);
}

TEST(PossibleNumbers, HaveNoDiffusionOfAFlightNorItsLine) {
    Results run = sample::results({1, 120, 40, true, "A"});
    for (ObservableResult& observable : run.observables) {
        if (observable.name != "msd") continue;
        observable.measurements = {{"d_liquid", "a^2/time unit", 3, 0.1, 9, ""},
                                   {"exponent_liquid", "-", 1.92, 0.01, 9, ""},
                                   {"d_solid", "a^2/time unit", 1, 0.1, 9, ""},
                                   {"exponent_solid", "-", 1.02, 0.01, 9, ""}};
        observable.curves.push_back(
            {"msd_fit",
             "",
             {{"t", "time unit", "", {1, 2, 3}}, {"msd", "a^2", "", {4, 5, 6}}},
             {{"phase", {"liquid", "solid", "liquid"}}}});
    }
    run = with_possible_numbers(run);
    EXPECT_FALSE(number(run, "msd", "d_liquid").value);
    EXPECT_THAT(number(run, "msd", "d_liquid").reason, HasSubstr("t^1.92"));
    EXPECT_TRUE(number(run, "msd", "exponent_liquid").value);
    EXPECT_TRUE(number(run, "msd", "d_solid").value);
    EXPECT_EQ(run.find("msd")->find_curve("msd_fit")->columns[1].values, std::vector<double>{5});
}

TEST(LeaveOutIncomparable, TakesTheWallsOfOneFrameOutOfTheSpectraOfOthers) {
    std::vector<Results> runs{sample::results({1, 120, 40, true, "film"}),
                              sample::results({2, 120, 40, false, "frame"})};
    leave_out_incomparable(runs);
    EXPECT_NE(runs[1].find("sk")->find_curve("sk"), nullptr) << "a periodic box has no walls";
    runs[1].box.boundary = {Boundary::walls, Boundary::walls};
    leave_out_incomparable(runs);
    EXPECT_NE(runs[0].find("sk")->find_curve("sk"), nullptr);
    EXPECT_EQ(runs[1].find("sk")->find_curve("sk"), nullptr);
    EXPECT_THAT(runs[1].find("sk")->reason, HasSubstr("walls"));
    std::vector<Results> alone{sample::results({2, 120, 40, false, "frame"})};
    alone[0].box.boundary = {Boundary::walls, Boundary::walls};
    leave_out_incomparable(alone);
    EXPECT_NE(alone[0].find("sk")->find_curve("sk"), nullptr) << "all there is";
}

}  // namespace
}  // namespace grainfield::report
