#include "app/critical_command.h"

#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "core/errors.h"
#include "io/h5/results_file.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::app {
namespace {

TEST(CriticalCommand, RefusesValuesThatAreNotNumbers) {
    for (const char* values : {"six", "1,", "5.5,nan", "1;2"}) {
        CriticalCommand command;
        std::vector<OptionTable> tables = command.options();
        Session session;
        session.command = "critical";
        session.inputs = {"a.h5"};
        const auto run = [&] {
            tables.front().set("output", OptionValue(std::string("critical.h5")));
            tables.front().set("values", OptionValue(std::string(values)));
            command.run(session);
        };
        EXPECT_THROW(run(), Error) << values;
        EXPECT_TRUE(session.outputs.empty());
    }
}

// Results whose S0/S1 is `ratio`.
std::filesystem::path write_run(const std::filesystem::path& path, double ratio) {
    Results run;
    run.box = {{0, 0}, {1, 1}, {}, 0};
    ObservableResult fit;
    fit.name = "fit";
    fit.measurements = {{"s0_over_s1", "-", ratio, 0.01, 100, ""}};
    run.observables = {fit};
    io::write_results(path, run, Overwrite::force);
    return path;
}

TEST(CriticalCommand, PrintsWhatJsonHoldsAndWritesNoFile) {
    const testing::ScratchFolder folder;
    CriticalCommand command;
    const std::vector<OptionTable> tables = command.options();
    tables.front().set("output", OptionValue(std::string("-")));
    tables.front().set("values", OptionValue(std::string("4,4.3,4.6")));
    Session session;
    session.command = "critical";
    session.inputs = {write_run(folder / "a.h5", 0.7), write_run(folder / "b.h5", 0.4),
                      write_run(folder / "c.h5", 0.1)};
    const Summary summary = command.run(session);
    EXPECT_TRUE(summary.is_table);
    const auto printed = nlohmann::json::parse(summary.text);
    EXPECT_EQ(printed["runs"], 3);
    EXPECT_NEAR(printed["critical_value"]["value"], 4.7, 1e-9);  // 0.7 − (Γ − 4) = 0
    EXPECT_TRUE(printed["outputs"].empty());
    EXPECT_EQ(folder.entries(), 3U) << "the inputs";
}

TEST(CriticalCommand, EndsAsABadInputWhereThePointsGiveNoValue) {
    const testing::ScratchFolder folder;
    CriticalCommand command;
    const std::vector<OptionTable> tables = command.options();
    tables.front().set("output", OptionValue(folder / "critical.h5"));
    tables.front().set("values", OptionValue(std::string("4,4.3")));
    Session session;
    session.command = "critical";
    session.inputs = {write_run(folder / "a.h5", 0.7), write_run(folder / "b.h5", 0.4)};
    const Summary summary = command.run(session);
    EXPECT_EQ(summary.code, ExitCode::bad_input);
    ASSERT_EQ(session.plan.warnings().size(), 1U);
    EXPECT_THAT(session.plan.warnings()[0].text,
                ::testing::AllOf(::testing::HasSubstr("2 runs with S0/S1 and its error, 3 are"),
                                 ::testing::HasSubstr("add runs at other values")));
    const Results out = io::read_results(folder / "critical.h5");
    EXPECT_NE(out.find("critical")->find_curve("critical"), nullptr) << "the points are kept";
}

}  // namespace
}  // namespace grainfield::app
