#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

using testing::Words;

/// A small job; what stands in `more` as "--name value" replaces the default.
Words job(const std::string& output, const Words& more = {}) {
    Words words{"simulate", "field", "-o", output, "--json"};
    const std::vector<std::pair<std::string, std::string>> defaults{
        {"--nx", "32"},    {"--relax", "100"}, {"--record", "3000"},
        {"--sample", "5"}, {"--store", "300"}, {"--threads", "2"}};
    for (const auto& [name, value] : defaults) {
        if (std::ranges::find(more, name) == more.end()) words.insert(words.end(), {name, value});
    }
    words.insert(words.end(), more.begin(), more.end());
    return words;
}

/// The numbers of a field file: curves and fields, without times and records.
std::string content(const ScratchFolder& folder, const std::string& file) {
    const std::string results = folder / "content-results.h5";
    std::string text;
    for (const bool from_fields : {false, true}) {
        Words words{"analyze", file, "-o", results, "--force", "--quiet"};
        if (from_fields) words.push_back("--from-fields");
        EXPECT_EQ(run_grainfield(words).code, 0);
        EXPECT_EQ(
            run_grainfield({"export", results, "-o", folder / "content/", "--force", "--quiet"})
                .code,
            0);
        std::vector<std::filesystem::path> paths;
        for (const auto& entry : std::filesystem::directory_iterator(folder / "content")) {
            paths.push_back(entry.path());
        }
        std::ranges::sort(paths);
        for (const auto& path : paths) text += path.filename().string() + testing::read_all(path);
    }
    EXPECT_THAT(text, HasSubstr("sk.csv"));
    return text;
}

TEST(SimulateField, GoesThroughAnalyzeExportAndCompare) {
    const ScratchFolder folder;
    const Outcome run = run_grainfield(job(folder / "f.h5"));
    ASSERT_EQ(run.code, 0) << run.err;
    const json summary = json::parse(run.out);
    EXPECT_EQ(summary["command"], "simulate field");
    EXPECT_EQ(summary["steps"], 6200);
    EXPECT_EQ(summary["scheme"], "lod");
    EXPECT_GT(summary["ms_per_step"], 0);
    EXPECT_LT(summary["mass_drift"], 1e-4);
    ASSERT_EQ(folder.entries(), 1U);  // no checkpoint is left
    EXPECT_THAT(
        run_grainfield({"info", folder / "f.h5"}).out,
        AllOf(HasSubstr("density fields"), HasSubstr("32 x 32"), HasSubstr("field, 2D, b = ")));
    const std::string text = content(folder, folder / "f.h5");
    EXPECT_THAT(text, AllOf(HasSubstr("variance.csv"), HasSubstr("sk_order.csv")));
    ASSERT_EQ(run_grainfield({"analyze", folder / "f.h5", "-o", folder / "r.h5"}).code, 0);
    const std::string info = run_grainfield({"info", folder / "r.h5"}).out;
    EXPECT_THAT(info, AllOf(HasSubstr("field model"), HasSubstr("20.8 x 20.8 l, periodic")));
    EXPECT_THAT(info, Not(AnyOf(HasSubstr("particles"), HasSubstr("diameter")))) << "of no field";
    EXPECT_EQ(run_grainfield({"compare", folder / "r.h5", "-o", folder / "report.html"}).code, 0);
}

// S0/S1 of small lattices falls with ν as on large ones; the line through it meets zero near ν = 0
// (docs/field.md). S0/S1 has no unit: k is in inverse lengths of the model, α the same.
TEST(SimulateField, GivesACriticalLineInNu) {
    const ScratchFolder folder;
    const Outcome runs = run_grainfield(
        job(folder / "f.h5", {"--nu-list", "0.02,0.01,0.005", "--nx", "64", "--relax", "1000",
                              "--record", "20000", "--store", "20000"}));
    ASSERT_EQ(runs.code, 0) << runs.err;
    Words words{"critical"};
    std::vector<double> ratios;
    for (const char* nu : {"0.02", "0.01", "0.005"}) {
        const std::string name = folder / (std::string("f-nu") + nu + ".h5");
        const std::string results = folder / (std::string("r") + nu + ".h5");
        const Outcome analysed =
            run_grainfield({"analyze", name, "-o", results, "--fit-k-max", "0.7", "--json"});
        ASSERT_EQ(analysed.code, 0) << analysed.err;
        const json fit = json::parse(analysed.out)["fit"];
        ASSERT_EQ(fit["name"], "s0_over_s1");
        ASSERT_EQ(fit["unit"], "-");
        ratios.push_back(fit["value"].get<double>());
        words.push_back(results);
    }
    EXPECT_GT(ratios[0], ratios[1]);
    EXPECT_GT(ratios[1], ratios[2]);
    words.insert(words.end(), {"-o", folder / "c.h5", "--parameter", "model.nu", "--json"});
    const Outcome critical = run_grainfield(words);
    ASSERT_EQ(critical.code, 0) << critical.err;
    const json summary = json::parse(critical.out);
    EXPECT_EQ(summary["runs"], 3);
    // 260 on lattices of 128² with longer runs; here 274 ± 51, and zero at
    // (−5 ± 13) · 10⁻⁴: three standard errors.
    EXPECT_NEAR(summary["slope"]["value"].get<double>(), 260, 153);
    EXPECT_NEAR(summary["critical_value"]["value"].get<double>(), 0, 0.004);
    EXPECT_EQ(run_grainfield({"export", folder / "c.h5", "-o", folder / "c/"}).code, 0);
    EXPECT_THAT(testing::read_all(folder / "c/critical.csv"), HasSubstr("x,s0_over_s1,err"));
    EXPECT_EQ(run_grainfield({"compare", words[1], words[2], words[3], folder / "c.h5", "-o",
                              folder / "c.html"})
                  .code,
              0);
    EXPECT_THAT(testing::read_all(folder / "c.html"), HasSubstr("model.nu"));
}

TEST(SimulateField, ThreadsChangeNoNumber) {
    const ScratchFolder folder;
    std::string first;
    for (const char* threads : {"1", "2", "8"}) {
        // Large enough for four threads (field_plan.cpp, choose_threads).
        const Words words =
            job(folder / "f.h5", {"--force", "--threads", threads, "--nx", "256", "--relax", "20",
                                  "--record", "60", "--store", "30"});
        ASSERT_EQ(run_grainfield(words).code, 0);
        const std::string text = content(folder, folder / "f.h5");
        if (first.empty()) first = text;
        EXPECT_EQ(text, first) << threads;
    }
}

TEST(SimulateField, KeepsAnInterruptedRunUnlessForced) {
    const ScratchFolder folder;
    std::ofstream(folder / "f.h5.checkpoint") << "precious";
    const Outcome refused = run_grainfield(job(folder / "f.h5"));
    EXPECT_EQ(refused.code, 4) << refused.err;
    EXPECT_THAT(refused.err, AllOf(HasSubstr("f.h5.checkpoint"), HasSubstr("--resume")));
    EXPECT_EQ(testing::read_all(folder / "f.h5.checkpoint"), "precious");
    EXPECT_EQ(folder.entries(), 1U);
    EXPECT_EQ(run_grainfield(job(folder / "f.h5", {"--force"})).code, 0);
}

// The published scheme has no bound on its step but one on what it can bear.
TEST(SimulateField, FieldsThatAreNotFiniteAreNoResult) {
    const ScratchFolder folder;
    const Outcome outcome = run_grainfield(
        job(folder / "f.h5", {"--scheme", "paper", "--dt", "10", "--nu", "0.003", "--record",
                              "30000", "--sample", "50", "--store", "0"}));
    EXPECT_EQ(outcome.code, 5) << outcome.out;
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("no longer finite at step"), HasSubstr("scheme paper")));
    EXPECT_FALSE(std::filesystem::exists(folder / "f.h5"));
}

TEST(SimulateField, RefusesWhatCannotBe) {
    const ScratchFolder folder;
    const auto code = [&](const Words& more) {
        return run_grainfield(job(folder / "f.h5", more)).code;
    };
    EXPECT_EQ(code({"--b", "3"}), 2);
    EXPECT_EQ(code({"--scheme", "explicit"}), 2);  // dt = 0.5
    EXPECT_EQ(code({"--nu", "-1"}), 2);
    EXPECT_EQ(code({"--nu", "nan"}), 2);
    EXPECT_EQ(code({"--nu-list", "0.1,x"}), 2);
    EXPECT_EQ(code({"--scheme", "adjoint", "--waves", "0"}), 2);
    EXPECT_EQ(run_grainfield(job("/nonexistent/f.h5")).code, 4);
    EXPECT_EQ(folder.entries(), 0U);
}

TEST(SimulateField, OneFileForEachNu) {
    const ScratchFolder folder;
    ASSERT_EQ(run_grainfield(job(folder / "f.h5", {"--nu-list", "0.1,0.05"})).code, 0);
    EXPECT_TRUE(std::filesystem::exists(folder / "f-nu0.1.h5"));
    EXPECT_TRUE(std::filesystem::exists(folder / "f-nu0.05.h5"));
}

TEST(SimulateField, AListThatIsGoneOnWithKeepsWhatIsTheSameAndRefusesWhatIsNot) {
    const ScratchFolder folder;
    const auto with = [&](const Words& more) { return run_grainfield(job(folder / "f.h5", more)); };
    ASSERT_EQ(with({"--nu-list", "0.1"}).code, 0);
    const Outcome longer = with({"--nu-list", "0.1,0.05", "--resume"});
    ASSERT_EQ(longer.code, 0) << longer.err;
    const json outputs = json::parse(longer.out)["outputs"];
    ASSERT_EQ(outputs.size(), 2U) << longer.out;
    EXPECT_THAT(outputs[0].get<std::string>(), HasSubstr("f-nu0.1.h5"));
    const Outcome other = with({"--nu-list", "0.1,0.05", "--resume", "--nu", "0.3", "--b", "2"});
    EXPECT_EQ(other.code, 3);
    EXPECT_THAT(other.err, HasSubstr("--b: 4 there, 2 now"));
}

TEST(SimulateField, TheAdjointGivesACurveToo) {
    const ScratchFolder folder;
    const Outcome run = run_grainfield(
        job(folder / "f.h5", {"--scheme", "adjoint", "--waves", "2,4", "--nu", "0.1"}));
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_EQ(json::parse(run.out)["scheme"], "adjoint");
    ASSERT_EQ(run_grainfield({"analyze", folder / "f.h5", "-o", folder / "r.h5", "--json"}).code,
              0);
}

}  // namespace
}  // namespace grainfield
