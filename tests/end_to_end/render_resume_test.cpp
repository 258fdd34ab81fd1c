// `grainfield render` that is killed, interrupted and taken up again.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "core/support/random.h"
#include "tests/support/fingerprint.h"
#include "tests/support/md_words.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::Process;
using testing::program;
using testing::read_all;
using testing::ScratchFolder;
using testing::with;
using testing::Words;

/// A cell with periodic sides, which spheres cross, under a camera that loses frames.
class RenderResume : public ::testing::TestWithParam<const char*> {
 protected:
    void SetUp() override {
        const Outcome outcome = testing::run_grainfield(
            with(testing::md_words("90", "10"),
                 {"-o", layer_, "--periods", "7", "--discard", "1", "--snapshot-every", "0.2"}));
        ASSERT_EQ(outcome.code, 0) << outcome.err;
    }

    Words run(const Words& more = {}) const {
        return with(
            {"render", layer_, "-o", output_, "--truth", truth_, "--width", "220", "--height",
             "220", "--scale", "22", "--drop-rate", "0.1", "--checkpoint-every", "0", "--json"},
            more);
    }

    /// What a run leaves, with the positions of its truth: that of frames and of data.
    std::string state() const {
        std::string bytes;
        if (fs::is_directory(output_)) {
            std::vector<fs::path> pictures;
            for (const auto& entry : fs::directory_iterator(output_)) {
                pictures.push_back(entry.path());
            }
            std::sort(pictures.begin(), pictures.end());
            for (const fs::path& picture : pictures) {
                bytes += picture.filename().string() + read_all(picture);
            }
        } else {
            bytes = read_all(output_);
        }
        return bytes + testing::fingerprint(truth_);
    }

    void remove_output() const {
        fs::remove_all(output_);
        fs::remove(truth_);
    }

    /// The uninterrupted run, out of the way.
    std::string whole() {
        const auto start = std::chrono::steady_clock::now();
        const Outcome outcome = testing::run_grainfield(run());
        needed_ = std::chrono::steady_clock::now() - start;
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        const json summary = json::parse(outcome.out);
        EXPECT_GT(summary["lost_frames"], 0);
        frames_ = summary["frames"];
        EXPECT_EQ(summary["kept_frames"], 0);
        EXPECT_EQ(folder_.entries(), 2U) << "no checkpoint, no log";
        std::string found = state();
        remove_output();
        return found;
    }

    void kill_after_checkpoint() const {
        const Process process(program(run()));
        // That of the first frame may be the second one of a folder.
        process.let_work_until([&] { return is_there(); });
        process.send(SIGKILL);
        process.wait();
        ASSERT_TRUE(fs::exists(output_ + ".checkpoint"));
        ASSERT_FALSE(fs::exists(truth_)) << "it was done before it was killed";
    }

    /// Whether some frames are vouched for.
    bool is_there() const {
        if (!fs::exists(output_ + ".checkpoint")) return false;
        return !fs::is_directory(output_) || fs::exists(output_ + "/frame-000004.tif");
    }

    ScratchFolder input_, folder_;
    std::string layer_ = input_ / "md.h5";
    std::string output_ = folder_ / GetParam();
    std::string truth_ = folder_ / "truth.h5";
    std::chrono::duration<double> needed_{};
    int frames_ = 0;
};

INSTANTIATE_TEST_SUITE_P(Folder, RenderResume, ::testing::Values("frames"));
INSTANTIATE_TEST_SUITE_P(Mkv, RenderResume, ::testing::Values("film.mkv"));
INSTANTIATE_TEST_SUITE_P(Avi, RenderResume, ::testing::Values("film.avi"));

TEST_P(RenderResume, KilledAnywhereItEndsInTheSameFramesAndTruth) {
    const std::string expected = whole();
    kill_after_checkpoint();
    RandomStream random(23, "kill times");
    for (int kill = 0; kill < 5; ++kill) {
        const Process process(program(run({"--resume"})));
        std::this_thread::sleep_for(needed_ * random.uniform());
        process.send(SIGKILL);
        process.wait();
        if (!fs::exists(truth_)) continue;
        // It was done, all but the checkpoint's end perhaps.
        EXPECT_TRUE(state() == expected) << "after kill " << kill;
        for (const auto& entry : fs::directory_iterator(folder_.path())) {
            fs::remove_all(entry);
        }
    }
    const Outcome last = testing::run_grainfield(run({"--resume"}));
    ASSERT_EQ(last.code, 0) << last.err;
    EXPECT_TRUE(state() == expected);
    EXPECT_EQ(folder_.entries(), 2U) << "nothing is left beside the output";
}

TEST_P(RenderResume, WhatWasRenderedIsNotRenderedAgain) {
    const std::string expected = whole();
    kill_after_checkpoint();
    const Outcome resumed = testing::run_grainfield(run({"--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    const json summary = json::parse(resumed.out);
    EXPECT_EQ(summary["frames"], frames_);
    EXPECT_GT(summary["kept_frames"], 0);
    EXPECT_LT(summary["kept_frames"], frames_);
    EXPECT_TRUE(state() == expected);
}

TEST_P(RenderResume, InterruptedItKeepsWhatWasDoneAndSaysHowToGoOn) {
    const std::string expected = whole();
    Outcome outcome;
    for (int wait = 400; wait > 1; wait = wait * 2 / 3) {
        const Process process(program(run()));
        process.let_work(std::chrono::milliseconds(wait), SIGINT);
        process.send(SIGINT);
        outcome = process.wait();
        // A signal after the last frame leaves nothing to go on with.
        if (outcome.code == 130 && json::parse(outcome.out)["frames"] < frames_) break;
        remove_output();
    }
    ASSERT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("which are kept; --resume goes on from there"));
    const int done = json::parse(outcome.out)["frames"];
    EXPECT_LT(done, frames_);

    const Outcome again = testing::run_grainfield(run());
    EXPECT_EQ(again.code, 4) << "an interrupted run is not thrown away";
    EXPECT_THAT(again.err, HasSubstr("--resume goes on with it, --force starts anew"));
    const Outcome other = testing::run_grainfield(run({"--resume", "--aperture", "0.1"}));
    EXPECT_EQ(other.code, 3);
    EXPECT_THAT(other.err, HasSubstr("--aperture: "));
    const Outcome resumed = testing::run_grainfield(run({"--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_GE(json::parse(resumed.out)["kept_frames"], done);
    EXPECT_EQ(folder_.entries(), 2U);
    EXPECT_TRUE(state() == expected);
}

TEST_P(RenderResume, WithoutACheckpointItStartsFromTheBeginning) {
    const Outcome outcome = testing::run_grainfield(run({"--resume"}));
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_EQ(json::parse(outcome.out)["kept_frames"], 0);
    EXPECT_EQ(folder_.entries(), 2U);
}

TEST_P(RenderResume, ResumedWhenItIsCompleteItSaysSo) {
    ASSERT_EQ(testing::run_grainfield(run()).code, 0);
    const std::string before = state();
    const Outcome again = testing::run_grainfield(run({"--resume"}));
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out)["complete"], true);
    EXPECT_EQ(state(), before);
    const Outcome other = testing::run_grainfield(run({"--resume", "--blur", "0.9"}));
    EXPECT_NE(other.code, 0);
    EXPECT_THAT(other.err, HasSubstr("0.9 now"));
}

TEST_P(RenderResume, AnotherTrajectoryUnderTheSameNameIsRefused) {
    kill_after_checkpoint();
    const Outcome md = testing::run_grainfield(
        with(testing::md_words("80", "10"), {"-o", layer_, "--periods", "2", "--force"}));
    ASSERT_EQ(md.code, 0) << md.err;
    const Outcome refused = testing::run_grainfield(run({"--resume"}));
    EXPECT_EQ(refused.code, 3);
    EXPECT_THAT(refused.err, HasSubstr("input: "));
}

using RenderResumeFolder = RenderResume;
INSTANTIATE_TEST_SUITE_P(Folder, RenderResumeFolder, ::testing::Values("frames/"));

TEST_P(RenderResumeFolder, PicturesThatAreGoneOrDamagedAreMadeAgain) {
    const std::string expected = whole();
    const std::string name = output_.substr(0, output_.size() - 1);
    {
        const Process process(program(run()));
        process.let_write(name + "/frame-000012.tif");
        process.send(SIGKILL);
        process.wait();
    }
    ASSERT_TRUE(fs::exists(name + ".checkpoint")) << "beside the folder";
    std::vector<fs::path> pictures;
    for (const auto& entry : fs::directory_iterator(name)) pictures.push_back(entry.path());
    std::sort(pictures.begin(), pictures.end());
    ASSERT_GT(pictures.size(), 5U);
    fs::remove(pictures[1]);
    fs::resize_file(pictures[2], fs::file_size(pictures[2]) / 2);
    const Outcome resumed = testing::run_grainfield(run({"--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_TRUE(state() == expected);
}

}  // namespace
}  // namespace grainfield
