#include "report/page/key_numbers.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

using testing::HasSubstr;
using testing::Not;

Results run_with(std::vector<Measurement> measurements) {
    Results run;
    run.frames = 3;
    run.particles_mean = 10456.2;
    run.source.time_unit = TimeUnit::second;
    run.observables.resize(1);
    run.observables[0].name = "msd";
    run.observables[0].measurements = std::move(measurements);
    return run;
}

const std::vector<ObservableTitles> titles{
    {"msd", "Displacement", {{"d_liquid", "Diffusion coefficient, liquid"}}}};

const KeyNumberRow& row(const std::vector<KeyNumberRow>& rows, const std::string& name) {
    return *std::ranges::find(rows, name, &KeyNumberRow::name);
}

TEST(KeyNumbers, ShowValueErrorUnitAndSamples) {
    const auto rows =
        key_numbers({run_with({{"d_liquid", "a^2/time unit", 0.0125, 0.0002, 1e6, ""}})}, titles);
    const KeyNumberRow& d = row(rows, "d_liquid");
    EXPECT_EQ(d.quantity, "Diffusion coefficient, liquid");
    EXPECT_EQ(d.unit, "a²/s");
    EXPECT_EQ(d.numbers[0].value, "0.01250 ± 0.00020");
    EXPECT_EQ(d.numbers[0].samples, "1,000,000");
    EXPECT_EQ(row(rows, "Frames").numbers[0].value, "3");
    EXPECT_EQ(row(rows, "Particles per frame").numbers[0].value, "10,456");
}

TEST(KeyNumbers, WithoutATitleAreCalledByTheirNameWithSpaces) {
    const auto rows = key_numbers({run_with({{"my_own_number", "-", 1, 0.1, 1, ""}})}, titles);
    EXPECT_EQ(row(rows, "my_own_number").quantity, "my own number");
    EXPECT_EQ(row(rows, "my_own_number").observable, "Displacement");
}

TEST(KeyNumbers, GiveTheReasonWhereThereIsNoValue) {
    const auto rows = key_numbers(
        {run_with({{"d_all", "a^2/s", std::nullopt, std::nullopt, 0, "fewer than three lags"},
                   {"odd", "-", std::nan(""), 0.1, 5, ""}})},
        titles);
    EXPECT_EQ(row(rows, "d_all").numbers[0].value, "");
    EXPECT_EQ(row(rows, "d_all").numbers[0].note, "fewer than three lags");
    EXPECT_EQ(row(rows, "odd").numbers[0].note, "no value");
    EXPECT_THAT(key_numbers_html(rows, {"A"}), Not(HasSubstr("fewer than three lags")))
        << "what no run has takes no row";
}

TEST(KeyNumbers, NameAnObservableThatCouldNotBeMeasured) {
    Results run = run_with({});
    run.observables[0].reason = "one frame only";
    const auto rows = key_numbers({run}, titles);
    EXPECT_EQ(rows.back().observable, "Displacement");
    EXPECT_EQ(rows.back().numbers[0].note, "one frame only");
}

TEST(KeyNumbers, StandSideBySideInOneOrder) {
    const auto rows =
        key_numbers({run_with({{"a", "-", 1, 0.1, 1, ""}, {"c", "-", 1, 0.1, 1, ""}}),
                     run_with({{"b", "-", 2, 0.1, 1, ""}, {"c", "-", 3, 0.1, 1, ""}})},
                    titles);
    std::vector<std::string> names;
    for (const KeyNumberRow& r : rows) names.push_back(r.name);
    EXPECT_THAT(names, testing::ElementsAre("Frames", "Particles per frame", "a", "c", "b"));
    EXPECT_EQ(row(rows, "a").numbers[1].note, "not among the results of this run");
    EXPECT_EQ(row(rows, "c").numbers[1].value, "3.00 ± 0.10");
}

TEST(KeyNumbers, OfAnotherUnitCarryIt) {
    Results other = run_with({{"d", "a^2/time unit", 2, 0.1, 1, ""}});
    other.source.time_unit = TimeUnit::frame;
    const auto rows =
        key_numbers({run_with({{"d", "a^2/time unit", 1, 0.1, 1, ""}}), other}, titles);
    EXPECT_EQ(row(rows, "d").unit, "a²/s");
    EXPECT_EQ(row(rows, "d").numbers[1].value, "2.00 ± 0.10 a²/frame");
}

TEST(KeyNumbers, CountSamplesInWholes) {
    const auto rows = key_numbers(
        {run_with({{"few", "-", 1, 0.1, 8.74, ""}, {"one", "-", 1, 0.1, 1.505, ""}})}, titles);
    EXPECT_EQ(row(rows, "few").numbers[0].samples, "9");
    EXPECT_EQ(row(rows, "one").numbers[0].samples, "") << "of less than two no scatter is known";
}

TEST(KeyNumbersHtml, NumbersEachNoteOnce) {
    const Results run = run_with(
        {{"a", "-", 1, std::nullopt, 1, "no error"}, {"b", "-", 1, std::nullopt, 1, "no error"}});
    const std::string html = key_numbers_html(key_numbers({run, run}, titles), {"A", "B"});
    EXPECT_EQ(html.find("<li>no error</li>"), html.rfind("<li>no error</li>"));
    EXPECT_THAT(html, HasSubstr("<sup>1</sup>"));
    EXPECT_THAT(html, Not(HasSubstr("<sup>2</sup>")));
}

TEST(KeyNumbersHtml, EscapesEverything) {
    const std::string hostile = "<script>alert(1)</script>";
    Results run = run_with({{hostile, hostile, 1, 0.1, 1, hostile}});
    run.observables[0].name = hostile;
    const auto rows = key_numbers({run}, titles);
    EXPECT_THAT(key_numbers_html(rows, {hostile}), Not(HasSubstr("<script")));
    EXPECT_THAT(key_numbers_html(key_numbers({run, run}, titles), {hostile, hostile}),
                Not(HasSubstr("<script")));
}

}  // namespace
}  // namespace grainfield::report
