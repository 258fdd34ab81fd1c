#include "report/figures/figures.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/observables.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

sample::Scene small(std::uint64_t seed = 1) {
    return {seed, 200, 60, true, "run " + std::to_string(seed)};
}

const Figure& named(const std::vector<Figure>& figures, const std::string& name) {
    return *std::ranges::find(figures, name, &Figure::name);
}

TEST(RunLabels, AreCleanUniqueAndNeverEmpty) {
    std::vector<Results> runs(6);
    runs[0].label = "A";
    runs[1].label = "A";
    runs[2].label = "  ";
    runs[3].record.inputs = {{"/data/secret/layer.avi", 1, ""}};
    runs[4].label = "x\ny\xFF";
    for (int i = 0; i < 80; ++i) runs[5].label += "Γ";
    const auto labels = run_labels(runs);
    EXPECT_THAT(labels, ElementsAre("A", "A (2)", "run 3", "layer.avi", "x y\uFFFD",
                                    testing::EndsWith("Γ…")));
    EXPECT_EQ(labels[5].size(), 60 * 2 + std::string("…").size());
}

TEST(Figures, TakeTheCurvesOfTheAnalysis) {
    const std::vector<Results> runs{sample::results(small())};
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    ASSERT_EQ(figures.size(), 5U);
    for (const Figure& figure : figures) {
        EXPECT_TRUE(figure.has_data()) << figure.name;
        EXPECT_TRUE(figure.absent.empty()) << figure.name;
        for (const Series& series : figure.series) {
            EXPECT_EQ(series.x.size(), series.y.size());
            EXPECT_TRUE(series.error.empty() || series.error.size() == series.x.size());
        }
    }
    const Figure& sk = named(figures, "sk");
    EXPECT_EQ(sk.series[0].y, runs[0].find("sk")->find_curve("sk")->find("s")->values);
    EXPECT_EQ(sk.series[0].error, runs[0].find("sk")->find_curve("sk")->find("s_err")->values);
    EXPECT_TRUE(sk.may_be_linear);
}

TEST(Figures, ShowRawSpectraOnlyOnRequest) {
    const std::vector<Results> runs{sample::results(small())};
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    const Figure& sk = named(figures, "sk");
    ASSERT_EQ(sk.kinds.size(), 3U);
    EXPECT_TRUE(sk.kinds[0].shown);
    EXPECT_FALSE(sk.kinds[1].shown);
    EXPECT_FALSE(sk.kinds[2].shown);
}

TEST(Figures, SplitTheDisplacementByPhase) {
    const std::vector<Results> runs{sample::results(small())};
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    const Figure& msd = named(figures, "msd");
    ASSERT_EQ(msd.kinds.size(), 4U);
    EXPECT_EQ(msd.kinds[1].label, "liquid");
    EXPECT_EQ(msd.kinds[3].mark, Mark::guide);
    for (std::size_t s = 0; s < 3; ++s) EXPECT_EQ(msd.series[s].x.size(), 20U);
    EXPECT_EQ(msd.x.unit_text(), "s");
}

TEST(Figures, GuidesOfTheVarianceStartTogetherWithSlopesOneAndTwo) {
    const std::vector<Results> runs{sample::results(small())};
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    const Figure& variance = named(figures, "variance");
    std::vector<double> slopes;
    for (const Series& series : variance.series) {
        if (variance.kinds[series.kind].mark != Mark::guide) continue;
        slopes.push_back(std::log(series.y.back() / series.y.front()) /
                         std::log(series.x.back() / series.x.front()));
        EXPECT_DOUBLE_EQ(series.y.front(), *std::ranges::min_element(variance.series[0].y));
    }
    EXPECT_THAT(slopes, ElementsAre(testing::DoubleNear(1, 1e-9), testing::DoubleNear(2, 1e-9)));
}

// σ² of a gas on a line grows as ⟨N⟩ ∝ ℓ, that of the edge, two points, not at all.
TEST(Figures, GuidesOfTheVarianceOnALineHaveSlopesZeroAndOne) {
    std::vector<Results> runs{sample::results(small())};
    runs[0].identity.origin = Origin::field;
    runs[0].identity.dimension = 1;
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    const Figure& variance = named(figures, "variance");
    std::vector<std::pair<std::string, double>> guides;
    for (const Series& series : variance.series) {
        const Kind& kind = variance.kinds[series.kind];
        if (kind.mark != Mark::guide) continue;
        guides.emplace_back(kind.label, std::log(series.y.back() / series.y.front()) /
                                            std::log(series.x.back() / series.x.front()));
    }
    ASSERT_EQ(guides.size(), 2U);
    EXPECT_EQ(guides[0].first, "β = 0");
    EXPECT_NEAR(guides[0].second, 0, 1e-9);
    EXPECT_EQ(guides[1].first, "β = 2");
    EXPECT_NEAR(guides[1].second, 1, 1e-9);
}

TEST(Figures, OfACriticalPointStandFirstAndSayIt) {
    Results run;
    run.identity.role = RunRole::critical_point;
    ObservableResult critical;
    critical.name = "critical";
    critical.measurements = {{"critical_value", "-", 0.0012, 0.0004, 3, ""},
                             {"critical_low", "-", 0.0007, std::nullopt, 3, ""},
                             {"critical_high", "-", 0.0015, std::nullopt, 3, ""}};
    critical.curves = {{"critical",
                        "",
                        {{"x", "-", "ν", {0.01, 0.02}},
                         {"s0_over_s1", "-", "", {1, 2}},
                         {"err", "-", "", {0.1, 0.1}}},
                        {}}};
    run.observables = {critical};
    const std::vector<Results> runs{run};
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    const Figure& figure = named(figures, "critical");
    EXPECT_FALSE(figure.reading.empty()) << "or it stands below the main curves";
    EXPECT_EQ(figure.note,
              "Critical at ν = 0.00120 ± 0.00040; 68 %: 0.0007 … 0.0015. Line through 2 points.");
}

TEST(Figures, SayWhyARunHasNoCurve) {
    sample::Scene one_frame = small(2);
    one_frame.several_frames = false;
    std::vector<Results> runs{sample::results(small(1)), sample::results(one_frame),
                              sample::results(small(3))};
    std::erase_if(runs[2].observables, [](const auto& o) { return o.name == "msd"; });
    runs[2].observables.back().curves.clear();  // variance
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    const Figure& msd = named(figures, "msd");
    ASSERT_EQ(msd.absent.size(), 2U);
    EXPECT_EQ(msd.absent[0].run, 1U);
    EXPECT_EQ(msd.absent[0].reason, "one frame: displacements need two");
    EXPECT_EQ(msd.absent[1].run, 2U);
    EXPECT_THAT(msd.absent[1].reason, HasSubstr("not among the observables"));
    const Figure& variance = named(figures, "variance");
    ASSERT_EQ(variance.absent.size(), 1U);
    EXPECT_THAT(variance.absent[0].reason, HasSubstr("no curve 'variance'"));
    const Figure& phase = named(figures, "phase");
    ASSERT_EQ(phase.absent.size(), 1U);
    EXPECT_THAT(phase.absent[0].reason, HasSubstr("one moment"));
}

TEST(Figures, OfACurveWithoutNumbersOrColumnsSaySo) {
    std::vector<Results> runs{sample::results(small()), sample::results(small(2))};
    Curve& all_nan = runs[0].observables[3].curves[0];
    all_nan.columns[1].values.assign(all_nan.columns[1].values.size(), std::nan(""));
    runs[1].observables[3].curves[0].columns.erase(
        runs[1].observables[3].curves[0].columns.begin() + 1);
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    const Figure& sk = named(figures, "sk");
    ASSERT_EQ(sk.absent.size(), 2U);
    EXPECT_THAT(sk.absent[0].reason, HasSubstr("no finite value"));
    EXPECT_THAT(sk.absent[1].reason, HasSubstr("lacks the column 's'"));
}

TEST(Figures, DoNotMixTimeUnitsOnOneAxis) {
    std::vector<Results> runs{sample::results(small(1)), sample::results(small(2))};
    runs[1].source.time_unit = TimeUnit::frame;
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    const Figure& msd = named(figures, "msd");
    ASSERT_EQ(msd.absent.size(), 1U);
    EXPECT_EQ(msd.absent[0].reason, "its times are in frame, not in s");
}

TEST(Figures, LeaveOutRowsThatAreNotFinite) {
    std::vector<Results> runs{sample::results(small())};
    runs[0].observables[3].curves[0].columns[1].values[7] = std::nan("");
    const auto figures = make_figures(runs, run_labels(runs), analysis::figure_hints());
    EXPECT_EQ(named(figures, "sk").series[0].x.size(), 159U);
}

TEST(Figures, OfEmptyResultsAreAllAbsent) {
    const std::vector<Results> runs(1);
    for (const Figure& figure : make_figures(runs, run_labels(runs), analysis::figure_hints())) {
        EXPECT_FALSE(figure.has_data());
        EXPECT_EQ(figure.absent.size(), 1U);
    }
}

TEST(Figures, OfThePhasesAreAgainstTimeWhereItIsKnown) {
    std::vector<Results> runs{sample::results(small())};
    EXPECT_EQ(
        named(make_figures(runs, run_labels(runs), analysis::figure_hints()), "phase").x.title(),
        "Time t [s]");
    runs[0].source.time_unit = TimeUnit::frame;
    EXPECT_EQ(
        named(make_figures(runs, run_labels(runs), analysis::figure_hints()), "phase").x.title(),
        "Frame");
    // An older file without times.
    runs[0].source.time_unit = TimeUnit::second;
    for (ObservableResult& o : runs[0].observables) {
        if (o.name == "phase") {
            std::erase_if(o.curves[0].columns, [](const Column& c) { return c.name == "t"; });
        }
    }
    EXPECT_EQ(
        named(make_figures(runs, run_labels(runs), analysis::figure_hints()), "phase").x.title(),
        "Frame");
}

TEST(Figures, SayInTheTitleWhatLimitsTheMainCurve) {
    std::vector<Results> runs{sample::results(small())};
    for (ObservableResult& o : runs[0].observables) {
        if (o.name == "sk") o.curves[0].title = "Structure factor, raw: one frame, walls included";
    }
    EXPECT_EQ(named(make_figures(runs, run_labels(runs), analysis::figure_hints()), "sk").title,
              "Structure factor, raw: one frame, walls included");
}

TEST(Figures, NameTheOrderParameterAfterItsSymmetry) {
    std::vector<Results> runs{sample::results(small())};
    for (ObservableResult& o : runs[0].observables) {
        if (o.name == "q4") o.options = {{"symmetry", std::int64_t{6}}};
    }
    EXPECT_EQ(named(make_figures(runs, run_labels(runs), analysis::figure_hints()), "q4_histogram")
                  .x.label,
              "|Q₆|");
}

}  // namespace
}  // namespace grainfield::report
