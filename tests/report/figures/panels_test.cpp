#include "report/figures/panels.h"

#include <cmath>

#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

Figure shared_figure() {
    Figure figure;
    figure.name = "variance";
    figure.title = "Number variance";
    figure.x = {"l", "Window", "a", Scale::log, false, {{"a"}, {"l"}}};
    figure.y.scale = Scale::log;
    figure.runs = {"MD, Γ = 2", "field, 2D, ν = 1", "MD, Γ = 3", "field, 2D, ν = 2"};
    figure.kinds = {{"σ²", Mark::line, true}};
    figure.series = {{0, 0, {1, 10}, {1, 20}, {}},
                     {1, 0, {2, 20}, {5, 50}, {}},
                     {2, 0, {1, 10}, {2, 40}, {}},
                     {3, 0, {2, 20}, {6, 70}, {}}};
    figure.absent = {{1, "why not"}};
    add_power_law(figure, "β = 2", 2, 1, 1, 20);
    return figure;
}

std::vector<RunIdentity> identities() {
    return {{.origin = Origin::md},
            {.origin = Origin::field},
            {.origin = Origin::md},
            {.origin = Origin::field}};
}

TEST(Panels, HoldTheRunsOfOneOriginEach) {
    const std::vector<Figure> panels = panels_by_origin(shared_figure(), identities());
    ASSERT_EQ(panels.size(), 2U);
    EXPECT_EQ(panels[0].name, "variance_panel1");
    EXPECT_EQ(panels[0].title, "Number variance: MD");
    EXPECT_EQ(panels[0].runs, (std::vector<std::string>{"Γ = 2", "Γ = 3"}));
    EXPECT_EQ(panels[0].x.title(), "Window [a]");
    EXPECT_EQ(panels[1].x.title(), "Window [l]");
    ASSERT_EQ(panels[0].series.size(), 3U) << "two runs and the guide";
    EXPECT_EQ(panels[0].series[1].run, 1U);
    EXPECT_EQ(panels[0].series[1].y, (std::vector<double>{2, 40}));
}

TEST(Panels, AnchorGuidesInTheirOwnData) {
    const Figure field = panels_by_origin(shared_figure(), identities())[1];
    const Series& guide = field.series.back();
    EXPECT_DOUBLE_EQ(guide.x.front(), 2);
    EXPECT_DOUBLE_EQ(guide.y.front(), 5);
    EXPECT_NEAR(guide.x.back(), 20, 1e-12);
    EXPECT_NEAR(guide.y.back(), 500, 1e-9) << "slope 2";
}

TEST(Panels, OnALineHaveTheGuidesThatBelongThere) {
    const std::vector<GuideHint> guides{
        {.label = "β = 2", .exponent = 2, .on_a_line = {{"linear", 1}}}};
    auto runs = identities();
    runs[1].dimension = runs[3].dimension = 1;
    const Figure line = panels_by_origin(shared_figure(), runs, guides)[1];
    EXPECT_NEAR(line.series.back().y.back(), 50, 1e-9) << "slope 1";
    EXPECT_EQ(line.kinds.back().label, "linear");
    EXPECT_EQ(panels_by_origin(shared_figure(), runs, guides)[0].kinds.back().label, "β = 2");
    for (RunIdentity& run : runs) run.dimension = 1;
    const Series same = panels_by_origin(shared_figure(), runs, guides)[1].series.back();
    EXPECT_NEAR(same.y.back(), 500, 1e-9) << "the shared guide is that of lines already";
}

TEST(Panels, AreNotMadeForOneOrigin) {
    EXPECT_TRUE(
        panels_by_origin(shared_figure(), std::vector<RunIdentity>(4, {.origin = Origin::md}))
            .empty());
    EXPECT_TRUE(panels_by_origin(shared_figure(), {{.origin = Origin::md},
                                                   {.role = RunRole::critical_point},
                                                   {.origin = Origin::md},
                                                   {.role = RunRole::critical_point}})
                    .empty());
}

TEST(Panels, DoNotRepeatASingleRun) {
    Figure figure = shared_figure();
    std::erase_if(figure.series, [&](const Series& s) {
        return s.run == 3 && figure.kinds[s.kind].mark != Mark::guide;
    });
    const std::vector<Figure> panels = panels_by_origin(figure, identities());
    ASSERT_EQ(panels.size(), 1U);
    EXPECT_EQ(panels[0].runs, (std::vector<std::string>{"Γ = 2", "Γ = 3"}));
}

TEST(Panels, RunsWithoutDataNeedNoColour) {
    Figure figure = shared_figure();
    std::erase_if(figure.series, [](const Series& series) { return series.run == 0; });
    // The guide belongs to no run.
    figure.series.push_back(shared_figure().series.back());
    const Figure present = of_present_runs(figure);
    EXPECT_EQ(present.runs,
              (std::vector<std::string>{"field, 2D, ν = 1", "MD, Γ = 3", "field, 2D, ν = 2"}));
    ASSERT_EQ(present.series.size(), 4U);
    EXPECT_EQ(present.series[0].run, 0U);
    EXPECT_EQ(present.series[0].y, (std::vector<double>{5, 50}));
    EXPECT_EQ(present.series[1].run, 1U);
    EXPECT_EQ(present.series[3].y, shared_figure().series.back().y);
    EXPECT_TRUE(present.absent.empty());
}

}  // namespace
}  // namespace grainfield::report
