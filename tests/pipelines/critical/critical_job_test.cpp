#include "pipelines/critical/critical_job.h"

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/statistics/blocks.h"
#include "core/errors.h"
#include "io/h5/results_file.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

using ::testing::HasSubstr;

// Results whose S0/S1 is 0.7 (ν − 5.2), ν standing in the record.
std::filesystem::path write_run(const std::filesystem::path& path, double nu, bool has_fit = true,
                                const RunIdentity& identity = {},
                                std::optional<Measurement> s1 = std::nullopt) {
    Results run;
    run.identity = identity;
    run.label = path.stem().string();
    run.box = {{0, 0}, {1, 1}, {}, 0};
    ObservableResult fit;
    fit.name = "fit";
    fit.measurements = {{"s0_over_s1", "-", 0.7 * (nu - 5.2), 0.01, 100, ""}};
    if (s1) fit.measurements.push_back(*s1);
    if (!has_fit) {
        fit.measurements.clear();
        fit.reason = "no pre-peak";
    }
    run.observables = {fit};
    run.record.configuration = {{"field.nu", std::to_string(nu)}};
    io::write_results(path, run, Overwrite::force);
    return path;
}

struct Found {
    CriticalJobResult result;
    std::vector<std::string> warnings;
};

Found find(const testing::ScratchFolder& folder, std::vector<std::filesystem::path> inputs,
           CriticalJobOptions options) {
    Job job;
    job.command = "critical";
    job.overwrite = Overwrite::force;
    job.inputs = std::move(inputs);
    options.output = folder / "critical.h5";
    CriticalJobResult result = find_critical_point(options, job);
    std::vector<std::string> warnings;
    for (const Warning& warning : job.plan.warnings()) warnings.push_back(warning.text);
    return {std::move(result), std::move(warnings)};
}

CriticalJobOptions by_record(const std::string& parameter) {
    CriticalJobOptions options;
    options.parameter = parameter;
    return options;
}

CriticalJobOptions by_value(std::vector<double> values) {
    CriticalJobOptions options;
    options.values = std::move(values);
    return options;
}

TEST(CriticalJob, FindsWhereS0OverS1VanishesFromValuesOrFromTheRecords) {
    const testing::ScratchFolder folder;
    std::vector<std::filesystem::path> inputs;
    for (double nu : {5.5, 5.8, 6.4, 7.0}) {
        inputs.push_back(write_run(folder / ("run" + std::to_string(inputs.size()) + ".h5"), nu));
    }
    inputs.push_back(write_run(folder / "without.h5", 9, false));
    for (const CriticalJobOptions& options :
         {by_record("field.nu"), by_value({5.5, 5.8, 6.4, 7.0, 9})}) {
        const Found found = find(folder, inputs, options);
        const Measurement* value = found.result.critical.find_measurement("critical_value");
        ASSERT_NE(value, nullptr);
        EXPECT_NEAR(*value->value, 5.2, 1e-9);
        EXPECT_EQ(found.result.runs, 4U);
        const Results out = io::read_results(folder / "critical.h5");
        EXPECT_NE(out.find("critical")->find_curve("critical"), nullptr);
        ASSERT_EQ(out.record.warnings.size(), 1U);
        EXPECT_THAT(out.record.warnings[0].text, HasSubstr("no pre-peak"));
        EXPECT_EQ(found.warnings.size(), 1U);
    }
}

TEST(CriticalJob, SaysHowMuchLongerARunWithoutARiseWouldHaveToBe) {
    const testing::ScratchFolder folder;
    const std::vector<std::filesystem::path> inputs{
        write_run(folder / "a.h5", 6), write_run(folder / "b.h5", 7),
        write_run(folder / "weak.h5", 8, true, {}, Measurement{"s1", "-", 0.2, 0.5, 100, ""}),
        write_run(folder / "falling.h5", 9, true, {}, Measurement{"s1", "-", -2, 0.5, 100, ""}),
        write_run(folder / "unknown.h5", 10, true, {}, Measurement{"s1", "-", -1, 0.6, 100, ""})};
    const Found found = find(folder, inputs, by_value({6, 7, 8, 9, 10}));
    EXPECT_EQ(found.result.runs, 2U);
    ASSERT_EQ(found.warnings.size(), 4U);
    EXPECT_THAT(found.warnings[3], HasSubstr("2 runs with S0/S1 and its error, 3 are needed; the "
                                             "warnings say what the runs that are left out"));
    EXPECT_TRUE(has_no_value(found.result.critical));
    EXPECT_THAT(found.warnings[0], HasSubstr("S1 = 0.2 ± 0.5; a run 25 times as long"));
    EXPECT_THAT(found.warnings[1], HasSubstr("S1 = -2 ± 0.5; S falls"));
    EXPECT_THAT(found.warnings[2], HasSubstr("four times as long would show an S1 of 0.6"));
}

// 1.6 errors: an S0/S1 that a version before stored may be anything.
TEST(CriticalJob, LeavesOutARunWhoseS1IsNotAboveTwoErrors) {
    const testing::ScratchFolder folder;
    const std::vector<std::filesystem::path> inputs{
        write_run(folder / "a.h5", 6), write_run(folder / "b.h5", 7),
        write_run(folder / "c.h5", 8, true, {}, Measurement{"s1", "-", 0.8, 0.5, 100, ""}),
        write_run(folder / "d.h5", 9, true, {}, Measurement{"s1", "-", 0.8, {}, 100, ""})};
    const Found found = find(folder, inputs, by_value({6, 7, 8, 9}));
    EXPECT_EQ(found.result.runs, 2U);
    ASSERT_EQ(found.warnings.size(), 3U);
    EXPECT_THAT(found.warnings[2], HasSubstr("there is no critical value"));
    EXPECT_THAT(found.warnings[0], HasSubstr("S1 = 0.8 ± 0.5; a run 2 times as long"));
    EXPECT_THAT(found.warnings[1], HasSubstr("S1 has no error"));
}

TEST(CriticalJob, SaysWhyARunWithoutS0OverS1HasNone) {
    const testing::ScratchFolder folder;
    const std::vector<std::filesystem::path> inputs{
        write_run(folder / "a.h5", 6), write_run(folder / "b.h5", 7), folder / "growing.h5"};
    Results growing = io::read_results(inputs[0]);
    growing.label = "growing";
    growing.observables[0].measurements = {analysis::missing("s0_over_s1", "-", "S is not steady"),
                                           analysis::missing("s0", "-", "S is not steady"),
                                           analysis::missing("s1", "-", "S is not steady")};
    io::write_results(inputs[2], growing, Overwrite::force);
    const auto says = ::testing::Contains("'growing' is left out: S is not steady");
    EXPECT_THAT(find(folder, inputs, by_value({6, 7, 8})).warnings, says);
    // The others have no S(k) to be fitted again.
    CriticalJobOptions shared = by_value({6, 7, 8});
    shared.exponent = SharedExponent::yes;
    shared.output = folder / "critical.h5";
    Job job;
    job.command = "critical";
    job.overwrite = Overwrite::force;
    job.inputs = inputs;
    EXPECT_THROW(find_critical_point(shared, job), InputError);
    std::vector<std::string> warnings;
    for (const Warning& warning : job.plan.warnings()) warnings.push_back(warning.text);
    EXPECT_THAT(warnings, says);
}

TEST(CriticalJob, SaysWhatIsWrongWithTheControlParameter) {
    const testing::ScratchFolder folder;
    const std::vector<std::filesystem::path> inputs{write_run(folder / "a.h5", 6)};
    EXPECT_THROW(find(folder, inputs, {}), OptionError);
    EXPECT_THROW(find(folder, inputs, by_value({1, 2})), OptionError);
    EXPECT_THROW(find(folder, inputs, by_record("field.mu")), OptionError);
}

TEST(CriticalJob, RefusesOneFileGivenTwiceUnderAnyName) {
    const testing::ScratchFolder folder;
    const auto once = write_run(folder / "a.h5", 6);
    const auto other = write_run(folder / "b.h5", 7);
    std::filesystem::create_symlink(once, folder / "link.h5");
    for (const std::filesystem::path& again : {once, std::filesystem::path(folder / "link.h5")}) {
        try {
            find(folder, {once, other, again}, by_value({6, 7, 8}));
            FAIL() << again;
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), HasSubstr("inputs 1 and 3 are one file"));
        }
    }
}

TEST(CriticalJob, NeedsARunWithAFit) {
    const testing::ScratchFolder folder;
    const std::vector<std::filesystem::path> inputs{write_run(folder / "a.h5", 6, false)};
    EXPECT_THROW(find(folder, inputs, by_value({1})), InputError);
}

RunIdentity field_at(double nu, double gradient_order = 4) {
    return {.origin = Origin::field,
            .control = ControlValue{.parameter = ControlParameter::critical_distance, .value = nu},
            .gradient_order = gradient_order};
}

TEST(CriticalJob, TakesControlParameterAndSeriesFromTheIdentitiesOfTheRuns) {
    const testing::ScratchFolder folder;
    std::vector<std::filesystem::path> inputs;
    for (double nu : {5.5, 5.8, 6.4, 7.0}) {
        inputs.push_back(write_run(folder / ("run" + std::to_string(inputs.size()) + ".h5"), nu,
                                   true, field_at(nu)));
    }
    const Found found = find(folder, inputs, {});
    EXPECT_NEAR(*found.result.critical.find_measurement("critical_value")->value, 5.2, 1e-9);
    RunIdentity series = field_at(0);
    series.control = std::nullopt;
    series.role = RunRole::critical_point;
    const Results out = io::read_results(folder / "critical.h5");
    EXPECT_EQ(out.identity, series) << "whatever its label is";
    EXPECT_EQ(out.find("critical")->find_curve("critical")->find("x")->meaning, "ν");

    inputs.push_back(write_run(folder / "other.h5", 8, true, field_at(8, 2)));
    CriticalJobOptions labelled;
    labelled.label = "field, 2D, b = 4";
    find(folder, inputs, labelled);
    EXPECT_EQ(io::read_results(folder / "critical.h5").identity,
              RunIdentity{.role = RunRole::critical_point})
        << "runs of two series are of none";
}

}  // namespace
}  // namespace grainfield::pipelines
