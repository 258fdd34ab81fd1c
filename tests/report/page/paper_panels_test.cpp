#include "report/page/paper_panels.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/observables.h"
#include "report/figures/figure_files.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

using testing::HasSubstr;

// A tracked film with a spectrum and a fit that says S1 = 0.09, at an acceleration.
Results film(double gamma) {
    Results run = sample::results({1, 300, 80, true, "tracked, Γ"});
    run.identity.control = ControlValue{ControlParameter::acceleration, gamma};
    ObservableResult fit;
    fit.name = "fit";
    fit.measurements = {{"s1", "-", 0.09, 0.01, 5, ""}, {"k_pre_peak", "1/a", 0.26, 0.03, 5, ""}};
    run.observables.push_back(fit);
    run.previews[0].abs_q4.assign(run.previews[0].snapshot.size(), 0.5);
    return run;
}

Results critical_point(double value, double error) {
    Results run;
    run.identity = {.origin = Origin::video, .role = RunRole::critical_point};
    ObservableResult critical;
    critical.name = "critical";
    critical.measurements = {{"critical_value", "-", value, error, 3, ""}};
    critical.curves = {{"critical",
                        "",
                        {{"x", "-", "Γ", {3.5, 4, 4.5}},
                         {"s0_over_s1", "-", "", {0.3, 0.2, 0.05}},
                         {"err", "-", "", {0.05, 0.05, 0.05}}},
                        {}}};
    run.observables = {critical};
    return run;
}

const PaperPanel& panel(const std::vector<PaperPanel>& panels, const std::string& number) {
    return *std::ranges::find(panels, number, &PaperPanel::number);
}

const Series* mark(const Figure& figure, const std::string& words) {
    for (const Series& series : figure.series) {
        if (figure.kinds[series.kind].label.find(words) != std::string::npos) return &series;
    }
    return nullptr;
}

TEST(PaperPanels, WithoutOwnResultsShowCommittedOnesAndSaySo) {
    const auto panels = paper_panels({film(4)}, {"tracked, Γ = 4"}, analysis::figure_hints(),
                                     {film(3), critical_point(4, 0.2)});
    EXPECT_FALSE(panel(panels, "2a").committed) << "has its own";
    const PaperPanel& kept = panel(panels, "2b");
    EXPECT_EQ(kept.committed, Origin::video);
    ASSERT_TRUE(kept.figure);
    EXPECT_EQ(kept.figure->name, "paper_2b");
    EXPECT_EQ(kept.absent, "no run has an S₀/S₁ with its error");
    EXPECT_FALSE(panel(panels, "2h").figure) << "neither has it";
    EXPECT_FALSE(panel(panels, "2h").committed);
}

TEST(PaperPanels, OfCommittedMolecularDynamicsNameItAndFillNoOtherRow) {
    Results run = film(3);
    run.identity.origin = Origin::md;
    run.label = "committed MD, Γ = 3";
    Results ratios = critical_point(4, 0.2);
    ratios.identity.origin = Origin::md;
    ratios.label = "committed MD";
    const auto panels = paper_panels({}, {}, analysis::figure_hints(), {run, ratios});
    for (const char* number : {"2a", "2b", "2c"}) {
        const PaperPanel& kept = panel(panels, number);
        EXPECT_EQ(kept.committed, Origin::md) << number;
        ASSERT_TRUE(kept.figure) << number;
        EXPECT_THAT(kept.figure->runs, testing::Each(testing::StartsWith("committed MD")))
            << number;
    }
    EXPECT_THAT(figure_csv(*panel(panels, "2a").figure), HasSubstr("committed MD, Γ = 3"));
    for (const char* number : {"2d", "2e", "2f"}) {
        EXPECT_FALSE(panel(panels, number).figure) << number << ": a periodic layer";
        EXPECT_FALSE(panel(panels, number).committed) << number;
    }
}

TEST(PaperPanels, MarkThePaperNumbersInTheFiguresOfTheRuns) {
    const auto panels =
        paper_panels({film(4), film(3), critical_point(4, 0.2)},
                     {"tracked, Γ = 4", "tracked, Γ = 3", "tracked"}, analysis::figure_hints());
    ASSERT_EQ(panels.size(), 13U);
    const PaperPanel& spectrum = panel(panels, "2a");
    ASSERT_TRUE(spectrum.figure);
    EXPECT_EQ(spectrum.figure->name, "paper_2a");
    EXPECT_THAT(spectrum.figure->runs, testing::ElementsAre("Γ = 3", "Γ = 4"));
    const Series* peak = mark(*spectrum.figure, "pre-peak");
    ASSERT_NE(peak, nullptr);
    EXPECT_NEAR(std::ranges::min(peak->x), 0.15, 1e-12);
    EXPECT_NEAR(std::ranges::max(peak->x), 0.25, 1e-12);
    ASSERT_EQ(spectrum.lines.size(), 1U);
    EXPECT_THAT(spectrum.lines[0].words,
                HasSubstr("paper ≈ 0.2, ours 0.260 ± 0.030 (tracked, Γ = 4)"));
    EXPECT_EQ(spectrum.lines[0].verdict, "agrees");
}

TEST(PaperPanels, MarkTheCriticalValueOfThePaperAtItsDistanceFromOurs) {
    const auto panels =
        paper_panels({critical_point(4, 0.2)}, {"tracked"}, analysis::figure_hints());
    const PaperPanel& line = panel(panels, "2b");
    ASSERT_TRUE(line.figure);
    const Series* band = mark(*line.figure, "Γc = 4.73 ± 0.15");
    ASSERT_NE(band, nullptr);
    // ε = (4 - 4.73)/4 and the error 0.15/4.
    EXPECT_NEAR(std::ranges::min(band->x), -0.1825 - 0.0375, 1e-12);
    EXPECT_NEAR(std::ranges::max(band->x), -0.1825 + 0.0375, 1e-12);
    EXPECT_THAT(line.lines[0].verdict, HasSubstr("differs by 2.9 σ"));
}

TEST(PaperPanels, MarkItOnTheAxisOfTheParameterWhereOursIsNotKnown) {
    const auto panels = paper_panels({critical_point(4, 2)}, {"tracked"}, analysis::figure_hints());
    const Series* band = mark(*panel(panels, "2b").figure, "Γc = 4.73 ± 0.15");
    ASSERT_NE(band, nullptr);
    EXPECT_NEAR(std::ranges::min(band->x), 4.58, 1e-12);
    EXPECT_EQ(panel(panels, "2b").lines[0].verdict, "not resolved at this scale");
}

// Two films with a minimum of |Q4| each: one at the acceleration of the map, one above.
TEST(PaperPanels, SayTheNumbersOfTheRunThatIsDrawnUnderTheOrder) {
    std::vector<Results> runs{film(4.5), film(6)};
    for (std::size_t r = 0; r < runs.size(); ++r) {
        for (ObservableResult& observable : runs[r].observables) {
            for (Measurement& m : observable.measurements) {
                if (m.name == "q4_minimum") m.value = r == 0 ? 0.71 : 0.83;
            }
        }
    }
    const auto panels =
        paper_panels(runs, {"tracked, Γ = 4.5", "tracked, Γ = 6"}, analysis::figure_hints());
    const PaperPanel& order = panel(panels, "1b");
    ASSERT_TRUE(order.figure);
    EXPECT_THAT(order.figure->runs, testing::ElementsAre("tracked, Γ = 4.5"));
    std::size_t measured = 0;
    for (const auto& line : order.lines) {
        EXPECT_THAT(line.words, testing::Not(HasSubstr("Γ = 6")));
        measured += line.words.find("ours 0.710 ± 0.020 (tracked, Γ = 4.5)") != std::string::npos;
    }
    EXPECT_EQ(measured, 1U);
    ASSERT_FALSE(panel(panels, "2a").lines.empty());
    EXPECT_THAT(panel(panels, "2a").lines[0].words, HasSubstr("(tracked, Γ = 6)"));
}

TEST(PaperPanels, ShowNoKindThatIsHidden) {
    for (const PaperPanel& one : paper_panels({film(4)}, {"f"}, analysis::figure_hints())) {
        if (!one.figure) continue;
        for (const Kind& kind : one.figure->kinds) EXPECT_TRUE(kind.shown) << one.number;
        for (const Series& series : one.figure->series) {
            EXPECT_LT(series.kind, one.figure->kinds.size()) << one.number;
        }
    }
}

TEST(PaperPanels, SayWhyOneIsNotThere) {
    for (const PaperPanel& one : paper_panels({}, {}, analysis::figure_hints())) {
        EXPECT_FALSE(one.figure) << one.number;
        EXPECT_FALSE(one.absent.empty()) << one.number;
        EXPECT_FALSE(one.claim.empty()) << one.number;
    }
}

TEST(PaperMap, IsOfTheRunNearestToTheAccelerationOfThePaper) {
    EXPECT_EQ(run_of_paper_map({film(3), film(4.4), film(5.5)}), 1U);
    Results true_positions = film(4.5);
    true_positions.identity.origin = Origin::rendered;
    EXPECT_EQ(run_of_paper_map({true_positions, film(3)}), 1U) << "found, not known";
    EXPECT_EQ(run_of_paper_map({true_positions}), std::nullopt);
}

TEST(PaperVerdict, CountsWhatAgreesDiffersAndIsOpen) {
    EXPECT_EQ(paper_verdict({}),
              "0 of 11 numbers of the paper agree, 0 differ, 11 are not "
              "resolved at this scale");
    EXPECT_EQ(paper_verdict({film(4), critical_point(4, 0.2)}),
              "2 of 11 numbers of the paper agree, 1 differs, 8 are not resolved at this scale");
}

}  // namespace
}  // namespace grainfield::report
