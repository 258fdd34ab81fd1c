#include "report/figures/critical_figures.h"

#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;

// S0/S1 = 2 (critical − x) at two values, with its line down to zero.
Results critical_run(const std::string& label, const std::string& parameter, double critical,
                     std::optional<double> error) {
    Results run;
    run.label = label;
    run.identity.role = RunRole::critical_point;
    ObservableResult result;
    result.name = "critical";
    result.measurements = {{"critical_value", "-", critical, error, 3, ""}};
    result.curves = {{"critical",
                      "",
                      {{"x", "-", parameter, {0.75 * critical, 0.5 * critical}},
                       {"s0_over_s1", "-", "", {0.5 * critical, critical}},
                       {"err", "-", "", {0.1, 0.2}}},
                      {}},
                     {"critical_line",
                      "",
                      {{"x", "-", parameter, {0.5 * critical, critical}},
                       {"s0_over_s1", "-", "", {critical, 0}},
                       {"err", "-", "", {0.1, 0.1}}},
                      {}}};
    run.observables = {result};
    return run;
}

std::vector<std::string> names(const std::vector<Figure>& figures) {
    std::vector<std::string> out;
    for (const Figure& figure : figures) out.push_back(figure.name);
    return out;
}

TEST(CriticalFigures, BringCriticalPointsOfSeveralSystemsToOneOrigin) {
    const std::vector<Results> runs{critical_run("film", "Γ", 4, 0.1),
                                    critical_run("MD", "Γ", 2, 0.1)};
    const std::vector<Figure> figures = critical_figures(runs, {"film", "MD"});
    ASSERT_EQ(names(figures), (std::vector<std::string>{"critical", "critical_epsilon"}));
    const Figure& figure = figures.back();
    EXPECT_EQ(figure.x.title(), "ε = (Γc − Γ)/Γc");
    ASSERT_EQ(figure.series.size(), 4U) << "points and line of both";
    for (const Series& series : figure.series) {
        const bool is_line = series.kind == 1;
        EXPECT_EQ(series.x,
                  (is_line ? std::vector<double>{0.5, 0} : std::vector<double>{0.25, 0.5}));
        EXPECT_EQ(series.error.size(), 2U);
    }
    EXPECT_EQ(figures.front().series.front().x, (std::vector<double>{3, 2})) << "as measured";
    EXPECT_THAT(figure.note,
                HasSubstr("film: the error of 4.00 ± 0.10 moves all points together by 0.025."));
    EXPECT_FALSE(figure.reading.empty()) << "or it stands below the main curves";
}

std::vector<std::string> guides(const Figure& figure) {
    std::vector<std::string> labels;
    for (const Kind& kind : figure.kinds) {
        if (kind.mark == Mark::guide) labels.push_back(kind.label);
    }
    return labels;
}

TEST(CriticalFigures, MarkWhereTheLineMeetsZeroAndItsInterval) {
    Results run = critical_run("MD", "Γ", 4, 0.1);
    run.observables[0].measurements.push_back({"critical_low", "-", 3.8, std::nullopt, 3, ""});
    run.observables[0].measurements.push_back({"critical_high", "-", 4.3, std::nullopt, 3, ""});
    const Figure figure = critical_figures({run}, {"MD"}).front();
    EXPECT_EQ(guides(figure),
              (std::vector<std::string>{"critical Γ = 4.00 ± 0.10", "68 % interval"}));
    const Series& crossing = figure.series[2];
    EXPECT_EQ(crossing.x, (std::vector<double>{4, 4}));
    EXPECT_EQ(crossing.y.front(), 0);
    const Series& interval = figure.series[3];
    EXPECT_EQ(interval.x, (std::vector<double>{3.8, 4.3, 4.3, 3.8, 3.8}));
    EXPECT_TRUE(figure.kinds[interval.kind].is_filled);
}

TEST(CriticalFigures, MarkNoCrossingFarFromAllPoints) {
    Results run = critical_run("MD", "Γ", 4, 0.1);
    run.observables[0].measurements[0].value = 9.3;
    EXPECT_EQ(guides(critical_figures({run}, {"MD"}).front()), std::vector<std::string>{});
}

TEST(CriticalFigures, DoNotJoinThePointsThatTheLineGoesThrough) {
    const Figure figure = critical_figures({critical_run("MD", "Γ", 4, 0.1)}, {"MD"}).front();
    EXPECT_FALSE(figure.kinds[0].is_joined);
    EXPECT_THAT(figure.note, HasSubstr("Line through 2 points."));
}

TEST(CriticalFigures, MeasureNoDistanceFromAPointThatIsHardlyKnown) {
    const std::vector<Results> runs{critical_run("good", "Γ", 4, 0.1),
                                    critical_run("vague", "Γ", 4, 1.1),
                                    critical_run("endless", "Γ", 4, std::nullopt)};
    const std::vector<Figure> figures = critical_figures(runs, {"good", "vague", "endless"});
    ASSERT_EQ(names(figures), (std::vector<std::string>{"critical", "critical_epsilon"}));
    EXPECT_EQ(figures.front().runs.size(), 3U);
    EXPECT_EQ(figures.back().runs, (std::vector<std::string>{"good"}));
    EXPECT_THAT(figures.back().note, HasSubstr("vague is not here"));
    EXPECT_THAT(figures.back().note, HasSubstr("endless is not here"));
    EXPECT_EQ(names(critical_figures({runs[1]}, {"vague"})),
              (std::vector<std::string>{"critical"}));
}

TEST(CriticalFigures, LeaveOutTheDistanceOfFieldsWhichIsTheirControlParameter) {
    const std::vector<Results> runs{critical_run("MD", "Γ", 2, 0.1),
                                    critical_run("field", "ν", -7e-4, 1e-5)};
    const std::vector<Figure> figures = critical_figures(runs, {"MD", "field"});
    ASSERT_EQ(names(figures),
              (std::vector<std::string>{"critical", "critical_2", "critical_epsilon"}));
    EXPECT_EQ(figures[1].x.title(), "ν");
    EXPECT_EQ(figures[2].runs, (std::vector<std::string>{"MD"}));
    EXPECT_THAT(figures[2].note, testing::Not(HasSubstr("field")));
}

TEST(CriticalFigures, NameADistanceInWordsWhereTheParameterHasNoSymbol) {
    const std::vector<Figure> figures =
        critical_figures({critical_run("MD", "vibration.amplitude", 0.09, 1e-3)}, {"MD"});
    ASSERT_EQ(figures.size(), 2U);
    EXPECT_EQ(figures[1].x.title(), "ε = 1 − control parameter over its critical value");
}

}  // namespace
}  // namespace grainfield::report
