// Case 17 of docs/reliability.md: SIGINT and SIGTERM are obeyed within two seconds.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::Process;
using testing::ScratchFolder;

/// A film too long to be finished before the signal: many names of one picture.
std::vector<std::string> long_film(const ScratchFolder& folder, int frames) {
    const std::string picture = folder / "picture.png";
    testing::write_png(picture, testing::disc_frame(testing::few_discs(), 0));
    std::vector<std::string> paths;
    for (int i = 0; i < frames; ++i) {
        paths.push_back(folder / fmt::format("frame_{:05}.png", i));
        std::filesystem::create_symlink(picture, paths.back());
    }
    return paths;
}

class Case17 : public ::testing::TestWithParam<int> {};

TEST_P(Case17, TrackingStopsInTimeAndKeepsTheFramesDoneSoFarUnderTheFinalName) {
    constexpr int frames = 3000;
    const ScratchFolder film, folder;
    std::vector<std::string> words{GRAINFIELD_PROGRAM, "track", "-o", folder / "tracks.h5",
                                   "--json"};
    for (const std::string& path : long_film(film, frames)) words.push_back(path);
    const Process process(words);
    // The output is claimed at once; it has content once tracking starts.
    const std::string partial = folder / "tracks.h5.partial";
    std::error_code absent;
    const auto has_content = [&] {
        const auto bytes = std::filesystem::file_size(partial, absent);
        return !absent && bytes > 0;
    };
    for (int i = 0; i < 3000 && !has_content(); ++i) {
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    const auto start = std::chrono::steady_clock::now();
    process.send(GetParam());
    const Outcome outcome = process.wait();
    const auto stopping = std::chrono::steady_clock::now() - start;

    EXPECT_EQ(outcome.code, 128 + GetParam()) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: interrupted after"));
    RecordProperty("milliseconds_to_stop",
                   static_cast<int>(stopping / std::chrono::milliseconds(1)));
    EXPECT_LT(stopping, std::chrono::seconds(2));
    const auto done = json::parse(outcome.out)["frames"].get<int>();
    EXPECT_GT(done, 0);
    EXPECT_LT(done, frames);
    EXPECT_EQ(folder.entries(), 3U) << "the final file, and what a resumed run needs";
    EXPECT_THAT(outcome.err, HasSubstr("; --resume goes on from there"));
    const Outcome info = testing::run_grainfield({"info", folder / "tracks.h5", "--json"});
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_EQ(json::parse(info.out)["frames"], done);
}

/// A table that takes seconds to export and to analyse: 60 frames of 20,000 points.
std::string long_table(const ScratchFolder& folder) {
    const std::string path = folder / "points.csv";
    std::ofstream file(path);
    file << "# grainfield points 1\n# diameter: 1\nframe,particle,x,y\n";
    for (int frame = 0; frame < 60; ++frame) {
        for (int i = 0; i < 20000; ++i) {
            file << frame << ',' << i << ',' << i % 141 + 0.01 * (i % 7) << ','
                 << i / 141 + 0.01 * (frame % 5) << '\n';
        }
    }
    return path;
}

TEST_P(Case17, ASimulationStopsInTimeAndLeavesACheckpoint) {
    const std::vector<std::vector<std::string>> jobs{
        {"simulate", "field", "--nx", "512", "--record", "1e5"},
        {"simulate", "md", "--grains", "2000", "--length-x", "46", "--length-y", "46", "--periods",
         "100000"}};
    for (const auto& job : jobs) {
        const ScratchFolder folder;
        const Process process(
            testing::program(testing::with(job, {"-o", folder / "f.h5", "--json"})));
        process.let_work(std::chrono::milliseconds(700), GetParam());
        const auto start = std::chrono::steady_clock::now();
        process.send(GetParam());
        const Outcome outcome = process.wait();
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2)) << job[1];
        EXPECT_EQ(outcome.code, 128 + GetParam()) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("--resume goes on from there"));
        EXPECT_TRUE(std::filesystem::exists(folder / "f.h5.checkpoint")) << job[1];
        EXPECT_FALSE(std::filesystem::exists(folder / "f.h5")) << job[1];
    }
}

TEST_P(Case17, AConversionStopsInTimeAndWritesNothing) {
    const ScratchFolder input;
    const std::string table = long_table(input);
    for (const std::string command : {"export", "analyze"}) {
        const ScratchFolder folder;
        const std::string output = folder / (command == "export" ? "x.csv" : "x.h5");
        const Process process({GRAINFIELD_PROGRAM, command, table, "-o", output});
        process.let_work(std::chrono::milliseconds(400), GetParam());
        const auto start = std::chrono::steady_clock::now();
        process.send(GetParam());
        const Outcome outcome = process.wait();
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2)) << command;
        EXPECT_EQ(outcome.code, 128 + GetParam()) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("x."));
        EXPECT_THAT(outcome.err, HasSubstr("was not written"));
        EXPECT_EQ(folder.entries(), 0U);
    }
}

// One frame takes much longer than there is time after a signal.
TEST_P(Case17, ASlowFrameDoesNotHoldUpTheEnd) {
    const ScratchFolder input;
    const std::string md = input / "md.h5";
    ASSERT_EQ(testing::run_grainfield({"simulate", "md", "--grains", "200", "--length-x", "16",
                                       "--length-y", "16", "--periods", "12", "-o", md})
                  .code,
              0);
    const std::vector<std::string> camera{"--optics",    "raytrace", "--scale",        "200",
                                          "--width",     "3200",     "--view-height",  "3200",
                                          "--tolerance", "0",        "--most-samples", "4096"};
    struct Job {
        std::vector<std::string> words;
        std::string output;
    };
    for (const Job& job :
         {Job{{"render", md}, "film.mkv"}, Job{{"validate", "--trajectory", md}, "page.html"}}) {
        const ScratchFolder folder;
        std::vector<std::string> words = testing::with(job.words, {"-o", folder / job.output});
        for (std::string option : camera) {
            if (job.words[0] == "render" && option == "--view-height") option = "--height";
            if (job.words[0] == "validate" && option == "--tolerance") {
                option = "--raytrace-tolerance";
            }
            words.push_back(option);
        }
        const Process process(testing::program(words));
        process.let_work(std::chrono::milliseconds(1500), GetParam());
        const auto start = std::chrono::steady_clock::now();
        process.send(GetParam());
        const Outcome outcome = process.wait();
        EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(2)) << job.output;
        EXPECT_EQ(outcome.code, 128 + GetParam()) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(job.output + "' was not written"));
        EXPECT_EQ(folder.entries(), 0U) << job.output;
    }
}

INSTANTIATE_TEST_SUITE_P(BySignal, Case17, ::testing::Values(SIGINT, SIGTERM),
                         [](const auto& instance) {
                             return instance.param == SIGINT ? std::string("Interrupt")
                                                             : std::string("Terminate");
                         });

}  // namespace
}  // namespace grainfield
