#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "tests/support/md_words.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::Process;
using testing::program;
using testing::ScratchFolder;
using testing::with;

std::vector<std::string> small_run(const std::string& output, const std::string& periods = "400") {
    return with(testing::small_md(),
                {"-o", output, "--periods", periods, "--snapshot-every", "7.3", "--json"});
}

/// Everything a run leaves: snapshots and time series as text.
std::string content(const ScratchFolder& folder, const std::string& name) {
    const std::string points = folder / (name + ".csv");
    const std::string curves = folder / (name + "-curves");
    const std::string file = folder / (name + ".h5");
    EXPECT_EQ(testing::run_grainfield({"export", file, "-o", points, "--force"}).code, 0);
    EXPECT_EQ(testing::run_grainfield({"export", file, "-o", curves, "--force"}).code, 0);
    return testing::read_all(points) + testing::read_all(curves + "/md.csv");
}

/// The first frames of a.h5 as text.
std::string snapshots(const ScratchFolder& folder, int frames) {
    const std::string points = folder / "points.csv";
    EXPECT_EQ(testing::run_grainfield({"export", folder / "a.h5", "-o", points, "--force"}).code,
              0);
    const std::string text = testing::read_all(points);
    std::filesystem::remove(points);
    std::filesystem::remove(points + ".meta");
    return text.substr(0, text.find(fmt::format("\n{},", frames)));
}

TEST(SimulateMd, KeepsTheContractForScripts) {
    const ScratchFolder folder;
    const Outcome outcome = testing::run_grainfield(small_run(folder / "a.h5"));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json summary = json::parse(outcome.out);
    for (const char* key :
         {"events", "events_per_second", "pair_per_grain_period", "low_plate_per_grain_period",
          "high_plate_per_grain_period", "energy_audit_relative_error", "max_overlap",
          "max_penetration", "fallbacks", "memory_mb"}) {
        EXPECT_TRUE(summary[key].is_number()) << key;
    }
    EXPECT_LT(summary["energy_audit_relative_error"], 1e-10);
    EXPECT_LT(summary["max_overlap"], 1e-12);
    EXPECT_EQ(folder.entries(), 1U) << "no snapshots, no checkpoint";
    const Outcome analysis =
        testing::run_grainfield({"analyze", folder / "a.h5", "-o", folder / "r.h5", "--json"});
    EXPECT_EQ(analysis.code, 0) << analysis.err;
}

TEST(SimulateMd, EnergiesAndOrderGoIntoTheAnalysisAndTheReport) {
    const ScratchFolder folder;
    const Outcome run = testing::run_grainfield(with(small_run(folder / "a.h5"), {"--order"}));
    ASSERT_EQ(run.code, 0) << run.err;
    const json summary = json::parse(run.out);
    const Outcome analysis =
        testing::run_grainfield({"analyze", folder / "a.h5", "-o", folder / "r.h5", "--json"});
    ASSERT_EQ(analysis.code, 0) << analysis.err;
    const json measured = json::parse(analysis.out);
    std::map<std::string, double> value;
    for (const std::string name : {"q4", "series"}) {
        for (const json& m : measured[name]["measurements"]) {
            if (m.contains("value")) value[name + "." + m["name"].get<std::string>()] = m["value"];
        }
    }
    EXPECT_NEAR(value["series.energy_xy"] / summary["energy_xy"].get<double>(), 1, 0.02);
    EXPECT_NEAR(value["series.pair"] / summary["pair_per_grain_period"].get<double>(), 1, 0.02);
    // The order of the run is that of its analysis: the same snapshots, the same rule.
    EXPECT_NEAR(value["series.q4_mean"] / value["q4.q4_mean"], 1, 0.05);
    const Outcome report =
        testing::run_grainfield({"compare", folder / "r.h5", "-o", folder / "r.html", "--quiet"});
    ASSERT_EQ(report.code, 0) << report.err;
    EXPECT_THAT(testing::read_all(folder / "r.html"), HasSubstr("Energies of the run"));
    EXPECT_THAT(testing::read_all(folder / "r_files/energies.csv"), HasSubstr("horizontal"));
}

TEST(SimulateMd, EveryPresetIsAValidConfiguration) {
    const std::filesystem::path samples = GRAINFIELD_SOURCE_DIR "/data-samples";
    int presets = 0;
    for (const auto& entry : std::filesystem::directory_iterator(samples)) {
        const std::string name = entry.path().filename();
        if (!name.starts_with("md-")) continue;
        ++presets;
        const Outcome plan = testing::run_grainfield(
            {"simulate", "md", "-c", entry.path(), "-o", "unused.h5", "--explain"});
        EXPECT_EQ(plan.code, 0) << name << ": " << plan.err;
    }
    EXPECT_GE(presets, 4);
}

TEST(SimulateMd, ThePresetOfAMinuteEndsInAReport) {
    const ScratchFolder folder;
    const std::string preset = GRAINFIELD_SOURCE_DIR "/data-samples/md-small.toml";
    const Outcome run =
        testing::run_grainfield({"simulate", "md", "-c", preset, "-o", folder / "a.h5", "--periods",
                                 "12", "--discard", "2", "--order"});
    ASSERT_EQ(run.code, 0) << run.err;
    EXPECT_THAT(run.out, HasSubstr("3 snapshots (2 of 12 periods discarded)"));
    const Outcome analysis =
        testing::run_grainfield({"analyze", folder / "a.h5", "-o", folder / "r.h5"});
    ASSERT_EQ(analysis.code, 0) << analysis.err;
    const Outcome report =
        testing::run_grainfield({"compare", folder / "r.h5", "-o", folder / "r.html"});
    ASSERT_EQ(report.code, 0) << report.err;
    const std::string page = testing::read_all(folder / "r.html");
    for (const char* part : {"Energies of the run", "Structure factor", "<h2>Positions</h2>"}) {
        EXPECT_THAT(page, HasSubstr(part));
    }
}

TEST(SimulateMd, TakesTheVibrationInTheUnitsOfALab) {
    const ScratchFolder folder;
    const auto run =
        with(testing::md_words("40", "10"), {"--periods", "2", "--force", "--snapshot-every", "1",
                                             "--gamma", "2.5", "-o", folder / "a.h5"});
    const Outcome lab =
        testing::run_grainfield(with(run, {"--frequency", "80", "--sphere-mm", "1"}));
    ASSERT_EQ(lab.code, 0) << lab.err;
    EXPECT_THAT(lab.out, AllOf(HasSubstr("ω = 5.0759"), HasSubstr("Γ = 2.5"), HasSubstr("80 Hz"),
                               HasSubstr("spheres of 1 mm")));
    const Outcome info = testing::run_grainfield({"info", folder / "a.h5"});
    EXPECT_THAT(info.out, AllOf(HasSubstr("1 mm, 1 a is 1 mm"), HasSubstr("Γ = 2.5, 80 Hz")));
    const Outcome twice =
        testing::run_grainfield(with(run, {"--amplitude", "0.08", "--angular-frequency", "5"}));
    EXPECT_EQ(twice.code, 2);
    EXPECT_THAT(twice.err, AllOf(HasSubstr("--gamma: 2.5"), HasSubstr("ω = 5 sqrt(g/a): 2")));
    const Outcome no_scale = testing::run_grainfield(with(run, {"--frequency", "80"}));
    EXPECT_EQ(no_scale.code, 2);
    EXPECT_THAT(no_scale.err, HasSubstr("--diameter-mm is not given"));
}

TEST(SimulateMd, TakesGammaOfTheCommandLineWithAFileThatHasAmplitudeAndFrequency) {
    const ScratchFolder folder;
    const std::vector<std::string> plan{"simulate", "md", "--explain", "-c",
                                        GRAINFIELD_SOURCE_DIR "/data-samples/md-small.toml"};
    const Outcome gamma = testing::run_grainfield(with(plan, {"--gamma", "4.7"}));
    ASSERT_EQ(gamma.code, 0) << gamma.err;
    EXPECT_THAT(gamma.out, HasSubstr("A = 0.188 a, ω = 5 sqrt(g/a), Γ = 4.7"));
    const Outcome lab =
        testing::run_grainfield(with(plan, {"--frequency", "80", "--sphere-mm", "1"}));
    ASSERT_EQ(lab.code, 0) << lab.err;
    EXPECT_THAT(lab.out, HasSubstr("A = 0.08 a, ω = 5.07586"));
    const Outcome both = testing::run_grainfield(
        with(plan, {"--gamma", "4.7", "--amplitude", "0.1", "--angular-frequency", "5"}));
    EXPECT_EQ(both.code, 2) << "all of it on the command line";
    EXPECT_THAT(both.err, AllOf(HasSubstr("--gamma: 4.7"), HasSubstr(": 2.5")));
    std::ofstream(folder / "both.toml")
        << "[vibration]\namplitude = 0.1\nangular-frequency = 5\ngamma = 4.7\n";
    const Outcome file =
        testing::run_grainfield({"simulate", "md", "--explain", "-c", folder / "both.toml"});
    EXPECT_EQ(file.code, 2) << file.out;
    EXPECT_THAT(file.err, HasSubstr("--gamma: 4.7")) << "all of it in the file";
}

TEST(SimulateMd, SaysBeforeItRunsThatNoSnapshotWillBeWritten) {
    const ScratchFolder folder;
    const auto run = with(testing::md_words("40", "10"),
                          {"-o", folder / "a.h5", "--periods", "3", "--discard", "5"});
    const Outcome plan = testing::run_grainfield(with(run, {"--explain"}));
    EXPECT_THAT(plan.out, HasSubstr("skip snapshots"));
    const Outcome done = testing::run_grainfield(run);
    EXPECT_EQ(done.code, 0);
    EXPECT_THAT(done.err, HasSubstr("no snapshot will be written"));
    const Outcome start = testing::run_grainfield(
        {"simulate", "md", "-o", folder / "b.h5", "--start", folder / "a.h5"});
    EXPECT_EQ(start.code, 3);
    EXPECT_THAT(start.err, HasSubstr("holds no snapshots"));
    EXPECT_EQ(testing::run_grainfield(with(run, {"--force", "--height", "1"})).code, 2) << "no gap";
    EXPECT_EQ(testing::run_grainfield({"simulate", "md", "-o", folder / "a.csv"}).code, 2);
}

TEST(SimulateMd, ThreadsDoNotChangeAByte) {
    const ScratchFolder folder;
    for (const char* threads : {"1", "2", "8"}) {
        const Outcome outcome = testing::run_grainfield(
            {"simulate", "md", "-o", folder / (std::string(threads) + ".h5"), "--grains", "6240",
             "--length-x", "40", "--length-y", "160", "--periods", "12", "--threads", threads,
             "--snapshot-every", "3"});
        ASSERT_EQ(outcome.code, 0) << outcome.err;
    }
    const std::string one = content(folder, "1");
    EXPECT_EQ(one, content(folder, "2"));
    EXPECT_EQ(one, content(folder, "8"));
}

TEST(SimulateMd, StopsWithinTwoSecondsAndGoesOnAsIfNothingHadHappened) {
    const ScratchFolder folder;
    ASSERT_EQ(testing::run_grainfield(small_run(folder / "whole.h5", "1500")).code, 0);
    const Process process(program(small_run(folder / "cut.h5", "1500")));
    process.let_work(std::chrono::milliseconds(300), SIGINT);
    const auto start = std::chrono::steady_clock::now();
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
    ASSERT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("--resume goes on from there"));
    const Outcome again = testing::run_grainfield(small_run(folder / "cut.h5", "1500"));
    EXPECT_EQ(again.code, 4) << "an interrupted run is not thrown away";
    const Outcome other = testing::run_grainfield(
        with(small_run(folder / "cut.h5", "1500"), {"--resume", "--amplitude", "0.09"}));
    EXPECT_EQ(other.code, 3);
    EXPECT_THAT(other.err, HasSubstr("--amplitude: 0.08 in the checkpoint, 0.09 now"));
    const Outcome resumed =
        testing::run_grainfield(with(small_run(folder / "cut.h5", "1500"), {"--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(content(folder, "cut"), content(folder, "whole"));
}

TEST(SimulateMd, ThatWasStoppedMayEndWhereItStands) {
    const ScratchFolder folder;
    const Process process(program(small_run(folder / "cut.h5", "100000")));
    process.let_work(std::chrono::milliseconds(400), SIGINT);
    process.send(SIGINT);
    const Outcome stopped = process.wait();
    ASSERT_EQ(stopped.code, 130) << stopped.err;
    const json before = json::parse(stopped.out);
    const std::string periods = fmt::format("{:.10g}", before["periods"].get<double>());
    EXPECT_THAT(stopped.err, HasSubstr("with --periods = " + periods + " writes what there is"));
    const Outcome ended =
        testing::run_grainfield(with(small_run(folder / "cut.h5", periods), {"--resume"}));
    ASSERT_EQ(ended.code, 0) << ended.err;
    EXPECT_LT(json::parse(ended.out)["energy_audit_relative_error"], 1e-10);
    EXPECT_EQ(folder.entries(), 1U);
}

TEST(SimulateMd, RefusesForeignAndDamagedCheckpoints) {
    const ScratchFolder folder;
    const std::string path = folder / "a.h5.checkpoint";
    const auto resume = with(small_run(folder / "a.h5"), {"--resume"});
    std::ofstream(path) << "something else";
    EXPECT_EQ(testing::run_grainfield(resume).code, 3);
    std::ofstream(path) << "grainfield checkpoint 1\nwith rubbish";
    const Outcome damaged = testing::run_grainfield(resume);
    EXPECT_EQ(damaged.code, 3);
    EXPECT_THAT(damaged.err, HasSubstr("checkpoint"));
    std::filesystem::remove(path);
    const Outcome anew = testing::run_grainfield(resume);
    EXPECT_EQ(anew.code, 0) << "where nothing is to be resumed it starts anew: " << anew.err;
}

TEST(SimulateMd, KeepsWhatWasSampledBeforeACollapse) {
    const ScratchFolder folder;
    const Outcome outcome = testing::run_grainfield(with(
        testing::md_words("200", "20.5"),
        {"-o", folder / "a.h5", "--periods", "400", "--snapshot-every", "0.5", "--amplitude", "0",
         "--plate-restitution", "0.5", "--grain-restitution", "0.9", "--event-limit", "20000"}));
    EXPECT_EQ(outcome.code, 5);
    EXPECT_THAT(outcome.err, HasSubstr("inelastic collapse: grain"));
    EXPECT_EQ(folder.entries(), 3U) << "the file, the checkpoint and its snapshots";
    const Outcome info = testing::run_grainfield({"info", folder / "a.h5"});
    EXPECT_EQ(info.code, 0) << info.err;
    EXPECT_THAT(info.out, HasSubstr("incomplete"));
    const std::string text = content(folder, "a");
    EXPECT_THAT(text, HasSubstr("energy_xy"));
    EXPECT_GT(std::count(text.begin(), text.end(), '\n'), 400) << "two snapshots and more";
}

// What was computed before a collapse is not lost: the run goes on from the beginning of the window
// in which it failed.
TEST(SimulateMd, GoesOnAfterACollapseWithAContactTime) {
    const ScratchFolder folder;
    const auto words = with(testing::md_words("200", "14"),
                            {"-o", folder / "a.h5", "--periods", "100", "--snapshot-every", "1",
                             "--gamma", "1.2", "--angular-frequency", "5", "--plate-restitution",
                             "0.95", "--grain-restitution", "0.95", "--json"});
    const Outcome failed = testing::run_grainfield(words);
    ASSERT_EQ(failed.code, 5);
    EXPECT_THAT(failed.err, AllOf(HasSubstr("The window began at period 30."),
                                  HasSubstr("--resume goes on from there")));
    const std::string before = snapshots(folder, 30);
    const Outcome again = testing::run_grainfield(with(words, {"--resume"}));
    EXPECT_EQ(again.code, 3) << "it would fail again";
    EXPECT_THAT(again.err, HasSubstr("expected another --contact-time or --event-limit"));
    const Outcome other = testing::run_grainfield(
        with(words, {"--resume", "--contact-time", "1e-4", "--height", "3"}));
    EXPECT_EQ(other.code, 3) << "nothing else may differ";
    EXPECT_THAT(other.err, HasSubstr("--height: 1.84"));
    const Outcome done =
        testing::run_grainfield(with(words, {"--resume", "--contact-time", "1e-4"}));
    ASSERT_EQ(done.code, 0) << done.err;
    EXPECT_EQ(json::parse(done.out)["periods"], 100);
    EXPECT_EQ(folder.entries(), 1U);
    EXPECT_EQ(snapshots(folder, 30), before) << "what was done stays";
    const Outcome info = testing::run_grainfield({"info", folder / "a.h5"});
    EXPECT_THAT(info.out, HasSubstr("--contact-time = 0.0001, 0 before"));
    EXPECT_THAT(info.out, Not(HasSubstr("incomplete")));
    const json facts =
        json::parse(testing::run_grainfield({"info", folder / "a.h5", "--json"}).out);
    EXPECT_EQ(facts["recorded_warnings"].size(), 1U);
    const Outcome analysis = testing::run_grainfield(
        {"analyze", folder / "a.h5", "--observables", "q4", "-o", folder / "r.h5"});
    EXPECT_THAT(analysis.err, HasSubstr("--contact-time = 0.0001, 0 before"));
}

TEST(SimulateMd, StopsWhileItMeltsTheLattice) {
    const ScratchFolder folder;
    const Process process(
        program({"simulate", "md", "-o", folder / "a.h5", "--grains", "20000", "--length-x", "30",
                 "--length-y", "30", "--height", "40", "--melt", "1000000"}));
    process.let_work(std::chrono::milliseconds(500), SIGINT);
    const auto start = std::chrono::steady_clock::now();
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_EQ(folder.entries(), 0U);
}

// Grains at rest hop millions of times in the first window.
TEST(SimulateMd, StopsWithinAWindowThatLastsLong) {
    const ScratchFolder folder;
    const auto run = with(testing::md_words("300", "20"),
                          {"-o", folder / "a.h5", "--gravity", "1e5", "--contact-time", "1e-5",
                           "--event-limit", "4000000000", "--periods", "20"});
    const Process process(program(run));
    process.let_work(std::chrono::milliseconds(700), SIGTERM);
    const auto start = std::chrono::steady_clock::now();
    process.send(SIGTERM);
    const Outcome outcome = process.wait();
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
    EXPECT_EQ(outcome.code, 143) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("interrupted after 0 of 20 periods; --resume goes on"));
    EXPECT_THAT(outcome.err, Not(HasSubstr("writes what there is"))) << "there is nothing";
    EXPECT_TRUE(std::filesystem::exists(folder / "a.h5.checkpoint"));
}

// Nothing is saved yet; making the places of six million grains takes seconds.
TEST(SimulateMd, StopsWhileItStarts) {
    const ScratchFolder folder;
    const Process process(program({"simulate", "md", "-o", folder / "a.h5", "--grains", "6000000",
                                   "--length-x", "2600", "--length-y", "2600", "--melt", "0"}));
    process.let_work(std::chrono::milliseconds(300), SIGTERM);
    const auto start = std::chrono::steady_clock::now();
    process.send(SIGTERM);
    const Outcome outcome = process.wait();
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
    EXPECT_EQ(outcome.code, 143) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("a.h5' was not written"));
    EXPECT_EQ(folder.entries(), 0U);
}

// The first checkpoint is made when the run is done; then its snapshots go to the output.
TEST(SimulateMd, StopsWhileItWritesTheSnapshots) {
    const ScratchFolder folder;
    const auto run = with(testing::small_md(), {"-o", folder / "a.h5", "--periods", "2",
                                                "--snapshot-every", "0.001", "--order"});
    const Process process(program(run));
    process.let_write(folder / "a.h5.checkpoint");
    const auto start = std::chrono::steady_clock::now();
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2));
    ASSERT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_TRUE(std::filesystem::exists(folder / "a.h5.checkpoint"));
    EXPECT_FALSE(std::filesystem::exists(folder / "a.h5"));
    const Outcome resumed = testing::run_grainfield(with(run, {"--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(folder.entries(), 1U);
}

TEST(SimulateMd, StartsOnlyFromTheSameCell) {
    const ScratchFolder folder;
    const std::vector<std::string> cell{"--grains",   "400",  "--length-x", "20.5",
                                        "--length-y", "20.5", "--periods",  "20"};
    const Outcome first = testing::run_grainfield(
        with({"simulate", "md", "-o", folder / "a.h5", "--snapshot-every", "10"}, cell));
    ASSERT_EQ(first.code, 0) << first.err;
    const std::vector<std::string> again{"simulate",      "md",      "-o",
                                         folder / "b.h5", "--start", folder / "a.h5"};
    EXPECT_EQ(testing::run_grainfield(with(again, {"--explain"})).code, 2);
    const Outcome plan =
        testing::run_grainfield(with(with(again, cell), {"--explain", "--threads", "2"}));
    EXPECT_EQ(plan.code, 0) << plan.err;
    EXPECT_THAT(plan.out, HasSubstr("skip layout"));
    EXPECT_THAT(plan.out, HasSubstr("skip strips of the cell: two need 64 rows"));
    EXPECT_FALSE(std::filesystem::exists(folder / "b.h5"));
    const Outcome other = testing::run_grainfield(again);
    EXPECT_EQ(other.code, 2);
    EXPECT_THAT(other.err, HasSubstr("--length-x"));
    const Outcome same = testing::run_grainfield(with(again, cell));
    EXPECT_EQ(same.code, 0) << same.err;
}

TEST(SimulateMd, RefusesWhatCannotFitBeforeItStarts) {
    const ScratchFolder folder;
    const Outcome outcome =
        testing::run_grainfield({"simulate", "md", "-o", folder / "a.h5", "--grains", "5000",
                                 "--length-x", "20", "--length-y", "20"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("at most"));
    EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace grainfield
