#include "app/critical_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/h5/results_file.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::app {
namespace {

using ::testing::HasSubstr;

// Results whose S0/S1 is 0.7 (ν − 5.2), ν standing in the record.
std::filesystem::path write_run(const std::filesystem::path& path, double nu, bool has_fit = true) {
    Results run;
    run.label = path.stem().string();
    run.box = {{0, 0}, {1, 1}, {}, 0};
    ObservableResult fit;
    fit.name = "fit";
    fit.measurements = {{"s0_over_s1", "-", 0.7 * (nu - 5.2), 0.01, 100, ""}};
    if (!has_fit) {
        fit.measurements.clear();
        fit.reason = "no pre-peak";
    }
    run.observables = {fit};
    run.record.configuration = {{"field.nu", std::to_string(nu)}};
    io::write_results(path, run, io::Overwrite::force);
    return path;
}

Summary run_command(const testing::ScratchFolder& folder, std::vector<std::filesystem::path> inputs,
                    std::vector<std::pair<std::string, std::string>> options) {
    CriticalCommand command;
    std::vector<OptionTable> tables = command.options();
    options.emplace_back("output", std::string(folder / "critical.h5"));
    for (const auto& [name, text] : options) tables.front().set(name, OptionValue(text));
    Session session;
    session.command = "critical";
    session.overwrite = Overwrite::force;
    session.inputs = std::move(inputs);
    return command.run(session);
}

TEST(CriticalCommand, FindsWhereS0OverS1VanishesFromValuesOrFromTheRecords) {
    const testing::ScratchFolder folder;
    std::vector<std::filesystem::path> inputs;
    for (double nu : {5.5, 5.8, 6.4, 7.0}) {
        inputs.push_back(write_run(folder / ("run" + std::to_string(inputs.size()) + ".h5"), nu));
    }
    inputs.push_back(write_run(folder / "without.h5", 9, false));
    for (const auto& option :
         {std::pair<std::string, std::string>{"parameter", "field.nu"},
          std::pair<std::string, std::string>{"values", "5.5, 5.8,6.4,7.0,9"}}) {
        const Summary summary = run_command(folder, inputs, {option});
        EXPECT_NEAR(summary.facts["critical_value"]["value"].get<double>(), 5.2, 1e-9);
        EXPECT_EQ(summary.facts["runs"], 4);
        const Results out = io::read_results(folder / "critical.h5");
        EXPECT_NE(out.find("critical")->find_curve("critical"), nullptr);
        ASSERT_EQ(out.record.warnings.size(), 1U);
        EXPECT_THAT(out.record.warnings[0], HasSubstr("no pre-peak"));
    }
}

TEST(CriticalCommand, SaysWhatIsWrongWithTheControlParameter) {
    const testing::ScratchFolder folder;
    const std::vector<std::filesystem::path> inputs{write_run(folder / "a.h5", 6)};
    EXPECT_THROW(run_command(folder, inputs, {}), OptionError);
    EXPECT_THROW(run_command(folder, inputs, {{"values", "1,2"}}), OptionError);
    EXPECT_THROW(run_command(folder, inputs, {{"values", "six"}}), OptionError);
    EXPECT_THROW(run_command(folder, inputs, {{"parameter", "field.mu"}}), OptionError);
}

}  // namespace
}  // namespace grainfield::app
