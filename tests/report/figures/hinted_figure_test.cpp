#include "report/figures/hinted_figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

Results run_with(std::vector<Column> columns,
                 std::map<std::string, std::vector<std::string>> words = {}) {
    Results run;
    run.source.diameter = 1;
    run.box = {{0, 0}, {20, 20}, {Boundary::periodic, Boundary::periodic}, 0};
    ObservableResult observable;
    observable.name = "o";
    observable.curves = {{"c", "The curve", std::move(columns), std::move(words)}};
    run.observables = {observable};
    return run;
}

FigureHint hint() {
    return {.name = "figure",
            .title = "A figure",
            .note = "",
            .x = {"l", "Length", "a", Scale::log, false},
            .y = {"v", "Value", "", Scale::log, false},
            .series = {{.label = "L = ", .from = {"o", "c", "l", "v", "err"}, .by = "side"}}};
}

std::vector<Column> columns() {
    return {{"l", "a", "", {1, 10, 100, 1, 10}},
            {"v", "-", "", {1, 5, 1e-9, 1, 6}},
            {"err", "-", "", {0.1, 0.1, 0, 0.1, 0.1}}};
}

const std::map<std::string, std::vector<std::string>> sides{
    {"side", {"100", "100", "100", "inf", "inf"}}};

TEST(HintedFigure, DrawsASeriesForEachWord) {
    const Figure figure = hinted_figure({run_with(columns(), sides)}, {"run"}, hint());
    ASSERT_EQ(figure.series.size(), 2U);
    EXPECT_EQ(figure.kinds[0].label, "L = 100");
    EXPECT_EQ(figure.kinds[1].label, "L = inf");
    EXPECT_THAT(figure.series[0].x, ElementsAre(1, 10, 100));
    EXPECT_EQ(figure.x.unit_text(), "a");
    EXPECT_TRUE(figure.absent.empty());
}

TEST(HintedFigure, LeavesOutANegligibleEnd) {
    FigureHint cut = hint();
    cut.series[0].negligible_end = 1e-6;
    const Figure figure = hinted_figure({run_with(columns(), sides)}, {"run"}, cut);
    EXPECT_THAT(figure.series[0].x, ElementsAre(1, 10));
    EXPECT_EQ(figure.series[0].error.size(), 2U);
    EXPECT_THAT(figure.series[1].x, ElementsAre(1, 10));
}

TEST(HintedFigure, KeepsOnLogarithmicAxesWhatTheyCanShowUnlessTheyMayBeLinear) {
    std::vector<Column> some = columns();
    some[1].values = {1, -5, 0, 1, 6};
    FigureHint plain = hint();
    plain.series[0].by = "";
    EXPECT_THAT(hinted_figure({run_with(some)}, {"run"}, plain).series[0].y, ElementsAre(1, 1, 6));
    plain.may_be_linear = true;
    EXPECT_EQ(hinted_figure({run_with(some)}, {"run"}, plain).series[0].y.size(), 5U);
}

TEST(HintedFigure, SaysWhyARunIsAbsent) {
    Results other;
    const Figure figure = hinted_figure({run_with(columns(), sides), other}, {"a", "b"}, hint());
    ASSERT_EQ(figure.absent.size(), 1U);
    EXPECT_EQ(figure.absent[0].run, 1U);
    EXPECT_THAT(figure.absent[0].reason, HasSubstr("not among the observables"));
}

TEST(HintedFigure, EndsAtHalfAPeriodicBoxAndSaysSo) {
    FigureHint half = hint();
    half.series[0].by = "";
    half.half_of_periodic_box = true;
    half.note_of_half_box = "half";
    std::vector<Column> some{{"l", "a", "", {1, 5, 10, 15}}, {"v", "-", "", {1, 2, 3, 4}}};
    const Figure figure = hinted_figure({run_with(some)}, {"run"}, half);
    EXPECT_THAT(figure.series[0].x, ElementsAre(1, 5, 10));
    EXPECT_EQ(figure.note, "half");
}

TEST(HintedFigure, TakesTheTitleOfTheCurveAndGuides) {
    FigureHint titled = hint();
    titled.series[0].by = "";
    titled.title_of_curve = true;
    titled.guides = {{.label = "slope 2", .exponent = 2, .note = "A guide."}};
    const Figure figure = hinted_figure(
        {run_with({{"l", "a", "", {1, 10}}, {"v", "-", "", {2, 20}}})}, {"run"}, titled);
    EXPECT_EQ(figure.title, "The curve");
    EXPECT_EQ(figure.kinds.back().mark, Mark::guide);
    EXPECT_NEAR(figure.series.back().y.back(), 200, 1e-9);
    EXPECT_EQ(figure.note, "A guide.");
}

TEST(HintedFigure, IsPresentAsItsHintSays) {
    FigureHint here = hint();
    const Runs without{Results{}};
    const Runs with{run_with(columns(), sides)};
    EXPECT_FALSE(is_present(without, here));
    EXPECT_TRUE(is_present(with, here));
    here.presence = Presence::always;
    EXPECT_TRUE(is_present(without, here));
    here.presence = Presence::with_observable;
    here.series[0].from.curve = "another";
    EXPECT_FALSE(is_present(without, here));
    EXPECT_TRUE(is_present(with, here));
}

}  // namespace
}  // namespace grainfield::report
