#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "core/support/random.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::Process;
using testing::run_grainfield;
using testing::ScratchFolder;

using Words = std::vector<std::string>;

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
    EXPECT_THAT(run_grainfield({"info", folder / "f.h5"}).out,
                AllOf(HasSubstr("density fields"), HasSubstr("32 x 32")));
    const std::string text = content(folder, folder / "f.h5");
    EXPECT_THAT(text, AllOf(HasSubstr("variance.csv"), HasSubstr("sk_order.csv")));
    ASSERT_EQ(run_grainfield({"analyze", folder / "f.h5", "-o", folder / "r.h5"}).code, 0);
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

TEST(SimulateField, KilledAnywhereItGoesOnAsIfNothingHadHappened) {
    const ScratchFolder folder;
    // Two threads share a lattice of this size.
    const Words longer{"--nx",    "192", "--record",           "300",
                       "--store", "100", "--checkpoint-every", "0.01"};
    ASSERT_EQ(run_grainfield(job(folder / "whole.h5", longer)).code, 0);
    const std::string whole = content(folder, folder / "whole.h5");
    RandomStream random(1, "kill times");
    Words words = job(folder / "f.h5", longer);
    words.insert(words.begin(), GRAINFIELD_PROGRAM);
    words.push_back("--resume");
    int kills = 0;
    for (; kills < 60 && !std::filesystem::exists(folder / "f.h5"); ++kills) {
        const Process process(words);
        process.let_work(std::chrono::milliseconds(20 + random.below(120)), SIGINT);
        process.send(SIGKILL);
        process.wait();
    }
    EXPECT_GT(kills, 3);
    if (!std::filesystem::exists(folder / "f.h5")) {
        words.erase(words.begin());
        const Outcome last = run_grainfield(words);
        ASSERT_EQ(last.code, 0) << last.err;
        // Only here: a kill may come between the last name given and the checkpoint's end.
        EXPECT_FALSE(std::filesystem::exists(folder / "f.h5.checkpoint"));
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "whole.h5.checkpoint"));
    EXPECT_EQ(content(folder, folder / "f.h5"), whole);
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

class InterruptedField : public ::testing::TestWithParam<int> {};

TEST_P(InterruptedField, LeavesACheckpointWithinTwoSecondsAndGoesOn) {
    const ScratchFolder folder;
    Words words = job(folder / "f.h5", {"--nx", "512", "--record", "1e5"});
    words.insert(words.begin(), GRAINFIELD_PROGRAM);
    const Process process(words);
    process.let_work(std::chrono::milliseconds(1500), GetParam());
    const auto start = std::chrono::steady_clock::now();
    process.send(GetParam());
    const Outcome outcome = process.wait();
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
    EXPECT_EQ(outcome.code, 128 + GetParam()) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("--resume goes on from there"));
    EXPECT_TRUE(std::filesystem::exists(folder / "f.h5.checkpoint"));
    EXPECT_FALSE(std::filesystem::exists(folder / "f.h5"));
    EXPECT_GT(json::parse(outcome.out)["steps"], 0);
    // Other options are refused with the difference, a damaged checkpoint with its name.
    words.erase(words.begin());
    words.insert(words.end(), {"--resume", "--nu", "0.5"});
    Outcome refused = run_grainfield(words);
    EXPECT_EQ(refused.code, 3);
    EXPECT_THAT(refused.err, HasSubstr("--nu: 0.01 in the checkpoint, 0.5 now"));
    std::filesystem::resize_file(folder / "f.h5.checkpoint", 5000);
    words.resize(words.size() - 2);
    refused = run_grainfield(words);
    EXPECT_EQ(refused.code, 3);
    EXPECT_THAT(refused.err, HasSubstr("f.h5.checkpoint"));
}

INSTANTIATE_TEST_SUITE_P(BothSignals, InterruptedField, ::testing::Values(SIGINT, SIGTERM));

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
