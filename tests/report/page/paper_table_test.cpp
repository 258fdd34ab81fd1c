#include "report/page/paper_table.h"

#include <algorithm>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

const RunIdentity critical_point{.origin = Origin::md, .role = RunRole::critical_point};
const PaperValue paper{"Γc", critical_point, "critical", "critical_value", 2.3, 0.03};

Measurement ours(double value, std::optional<double> error) {
    return {"critical_value", "-", value, error, 5, ""};
}

TEST(Verdict, SaysAgreesDiffersOrNotResolved) {
    const Measurement near = ours(2.36, 0.04);
    const Measurement far = ours(2.5, 0.04);
    const Measurement vague = ours(2.3, 0.6);
    const Measurement without = ours(2.3, std::nullopt);
    EXPECT_EQ(verdict(paper, &near).text(), "agrees") << "1.2 standard errors";
    EXPECT_EQ(verdict(paper, &far).text(), "differs by 4.0 σ");
    EXPECT_EQ(verdict(paper, &vague).text(), "not resolved at this scale");
    EXPECT_EQ(verdict(paper, &without).text(), "not resolved at this scale");
    EXPECT_EQ(verdict(paper, nullptr).text(), "not resolved at this scale");
}

TEST(PaperTable, HoldsEveryValueAndTakesTheRunOfTheCriticalPoint) {
    Results critical;
    critical.identity = critical_point;
    critical.observables.emplace_back().name = "critical";
    critical.observables[0].measurements = {ours(2.31, 0.02)};
    const std::vector<Results> runs{critical};
    const Table table = paper_table(runs, {"whatever it is called"});
    ASSERT_EQ(table.rows.size(), paper_values().size());
    const auto row = std::ranges::find_if(table.rows, [](const Table::Row& r) {
        return r.name.find("molecular") != std::string::npos;
    });
    ASSERT_NE(row, table.rows.end());
    EXPECT_EQ(row->cells[1].text, "2.310 ± 0.020");
    EXPECT_EQ(row->cells[2].text, "whatever it is called");
    EXPECT_EQ(row->cells[3].text, "agrees");
    EXPECT_EQ(table.rows[0].cells[1].text, "not measured");
    EXPECT_EQ(table.rows[0].cells[3].text, "not resolved at this scale");
}

TEST(PaperTable, PrintsTheErrorThatARoundedValueIsComparedWith) {
    const Table table = paper_table({}, {});
    for (const PaperValue& value : paper_values()) {
        if (!value.is_rounded) continue;
        const auto row = std::ranges::find(table.rows, value.name, &Table::Row::name);
        ASSERT_NE(row, table.rows.end());
        EXPECT_EQ(row->cells[0].text.find("≈ "), 0U);
        EXPECT_NE(row->cells[0].text.find(fmt::format(", taken as ± {:g}", value.error)),
                  std::string::npos)
            << row->cells[0].text;
    }
    const PaperValue narrow{"", critical_point, "q4", "q4_high_mode", 0.95, 0.025, true};
    EXPECT_EQ(paper_text_with_error(narrow), "≈ 0.95, taken as ± 0.025");
    EXPECT_EQ(paper_text_with_error(paper), "2.300 ± 0.030");
}

TEST(PaperTable, LetsTheRunWithTheLargestControlParameterSpeak) {
    const auto film = [](double gamma, double minimum, std::optional<double> error) {
        Results run;
        run.identity = {
            .origin = Origin::video,
            .control = ControlValue{.parameter = ControlParameter::acceleration, .value = gamma}};
        run.observables.emplace_back().name = "q4";
        run.observables[0].measurements = {{"q4_minimum", "-", minimum, error, 5, ""}};
        return run;
    };
    const std::vector<Results> runs{film(4, 0.6, 0.01), film(5, 0.7, 0.01),
                                    film(6, 0.8, std::nullopt)};
    const Table table = paper_table(runs, {"a", "b", "c"});
    const auto row = std::ranges::find_if(table.rows, [](const Table::Row& r) {
        return r.name.find("minimum") != std::string::npos;
    });
    ASSERT_NE(row, table.rows.end());
    EXPECT_EQ(row->cells[2].text, "b") << "the last one has no error";
}

}  // namespace
}  // namespace grainfield::report
