// `grainfield track` that is killed, interrupted and taken up again.
#include <chrono>
#include <filesystem>
#include <random>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::Process;
using testing::program;
using testing::ScratchFolder;
using testing::with;

/// Without the wall time, which no two runs share, and the checksum of the text that holds it: all
/// that is left out of the comparison of bytes.
std::string timeless(const std::string& path) {
    std::string bytes = testing::read_all(path);
    constexpr std::string_view key = "\"seconds\":";
    const std::size_t begin = bytes.find("{\"command\"");
    const std::size_t number = bytes.find(key, begin) + key.size();
    const std::size_t digits = bytes.find(',', number) - number;
    // Padded to 24 bytes more than it takes with "0.0".
    const std::string text = bytes.substr(begin, bytes.find("}  ", number) + 1 - begin);
    const std::size_t length = text.size() - digits + 3 + 24;
    EXPECT_LT(digits, 24U);
    EXPECT_LT(begin + length + 4, bytes.size());
    std::string rest = text;
    rest.erase(number - begin, digits);
    return bytes.substr(0, begin) + rest + bytes.substr(begin + length + 4);
}

class TrackResume : public ::testing::Test {
 protected:
    /// A film in which spheres leave, the light changes, a frame is repeated and one is damaged;
    /// a region, the cell and short tracks besides.
    std::vector<std::string> run(std::vector<std::string> more = {}) {
        if (frames_.empty()) {
            testing::LayerScene scene = testing::few_discs();
            for (int i = 0; i < 40; ++i) {
                frames_.push_back(film_ / fmt::format("frame_{:03}.png", i));
                if (i == 9) {
                    fs::copy_file(frames_[8], frames_[9]);
                    continue;
                }
                if (i == 17) scene.position.resize(scene.position.size() - 20);
                Image image = testing::disc_frame(scene, i);
                const float light = i > 20 ? 0.9F : 1.0F;
                for (float& v : image.pixels()) v = std::round(light * v);
                testing::write_png(frames_.back(), image);
            }
            fs::resize_file(frames_[25], 500);
        }
        std::vector<std::string> words{"track", "-o", folder_ / "t.h5", "--json"};
        words = with(words, {"--region", "5,3,180,180", "--previews", "5", "--height", "1.94",
                             "--sphere-diameter", "10", "--checkpoint-every", "0"});
        return with(with(with(words, kind_), std::move(more)), frames_);
    }

    /// The uninterrupted run, out of the way.
    std::string whole() {
        const Outcome outcome = testing::run_grainfield(run());
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(folder_.entries(), 1U) << "no checkpoint, no log";
        fs::rename(folder_ / "t.h5", film_ / "whole.h5");
        return timeless(film_ / "whole.h5");
    }

    Outcome stop_after_checkpoint(const std::vector<std::string>& words, int signal) {
        const Process process(program(words));
        process.let_write(folder_ / "t.h5.checkpoint");
        process.send(signal);
        return process.wait();
    }

    void kill_after_checkpoint(const std::vector<std::string>& words) {
        stop_after_checkpoint(words, SIGKILL);
        ASSERT_TRUE(fs::exists(folder_ / "t.h5.checkpoint"));
    }

    ScratchFolder film_, folder_;
    std::vector<std::string> frames_;
    /// The whole film, linked.
    std::vector<std::string> kind_{"--minimum-length", "4"};
};

TEST_F(TrackResume, KilledAnywhereItEndsInTheSameBytes) {
    const auto begin = std::chrono::steady_clock::now();
    const std::string expected = whole();
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    std::mt19937 random(11);
    // Within the time of a run on this machine, and of one that is slower by half.
    std::uniform_real_distribution<double> moment(0.2 * seconds, 1.5 * seconds);
    int resumed = 0;
    // How many kills come after a checkpoint depends on what else the machine does.
    for (int round = 0; round < 4 || (resumed <= 3 && round < 40); ++round) {
        int kills = 0;
        for (; kills < 40 && !fs::exists(folder_ / "t.h5"); ++kills) {
            if (fs::exists(folder_ / "t.h5.checkpoint")) ++resumed;
            const Process process(program(run({"--resume"})));
            std::this_thread::sleep_for(std::chrono::duration<double>(moment(random)));
            process.send(SIGKILL);
            process.wait();
        }
        if (!fs::exists(folder_ / "t.h5")) {
            const Outcome last = testing::run_grainfield(run({"--resume"}));
            ASSERT_EQ(last.code, 0) << last.err;
        }
        const std::string found = timeless(folder_ / "t.h5");
        EXPECT_EQ(found.size(), expected.size());
        ASSERT_TRUE(found == expected) << "round " << round << " after " << kills << " kills";
        if (fs::exists(folder_ / "t.h5.checkpoint")) {
            // A kill came between the last name given and the checkpoint's end: asked again, it
            // ends.
            const Outcome again = testing::run_grainfield(run({"--resume"}));
            ASSERT_EQ(again.code, 0) << again.err;
            EXPECT_TRUE(timeless(folder_ / "t.h5") == expected);
        }
        // One between the checkpoint's end and the log's leaves a log that vouches for nothing.
        fs::remove(folder_ / "t.h5.snapshots");
        EXPECT_EQ(folder_.entries(), 1U);
        fs::remove(folder_ / "t.h5");
    }
    EXPECT_GT(resumed, 3) << "of " << seconds
                          << " s: every run was killed before its first checkpoint or not at all";
}

TEST_F(TrackResume, APartOfAFilmKilledAfterACheckpointEndsInTheSameBytes) {
    // From the middle of a stretch to the middle of another one.
    kind_ = {"--no-link", "--frames", "10:34", "--stretch", "8"};
    const std::string expected = whole();
    kill_after_checkpoint(run());
    const Outcome resumed = testing::run_grainfield(run({"--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(json::parse(resumed.out)["frames"], 23) << "all but the damaged one";
    EXPECT_EQ(folder_.entries(), 1U);
    EXPECT_TRUE(timeless(folder_ / "t.h5") == expected);
    const Outcome linked =
        testing::run_grainfield({"link", folder_ / "t.h5", "-o", film_ / "x.h5", "--allow-gaps"});
    EXPECT_EQ(linked.code, 0) << linked.err;
}

TEST_F(TrackResume, InterruptedItKeepsWhatWasDoneAndSaysHowToGoOn) {
    const std::string expected = whole();
    Outcome outcome;
    // Where the machine is busy, the signal may come after the last frame: then once more.
    const auto cut_off = [&] {
        return outcome.code == 130 && json::parse(outcome.out)["frames"] < 39;
    };
    for (int tries = 0; tries < 20 && !cut_off(); ++tries) {
        fs::remove(folder_ / "t.h5");
        outcome = stop_after_checkpoint(run(), SIGINT);
    }
    ASSERT_TRUE(cut_off()) << outcome.code << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("; --resume goes on from there"));
    const Outcome info = testing::run_grainfield({"info", folder_ / "t.h5", "--json"});
    EXPECT_EQ(json::parse(info.out)["frames"], json::parse(outcome.out)["frames"]);

    const auto state = [&] {
        return testing::read_all(folder_ / "t.h5.checkpoint") +
               testing::read_all(folder_ / "t.h5.snapshots");
    };
    const std::string before = state();
    const Outcome again = testing::run_grainfield(run());
    EXPECT_EQ(again.code, 4) << "an interrupted run is not thrown away";
    EXPECT_THAT(again.err, HasSubstr("t.h5.checkpoint' exists: an interrupted run of"));
    EXPECT_THAT(again.err, HasSubstr("--resume goes on with it, --force starts anew"));
    EXPECT_TRUE(state() == before);
    const Outcome other = testing::run_grainfield(run({"--resume", "--memory", "1"}));
    EXPECT_EQ(other.code, 3);
    EXPECT_THAT(other.err, HasSubstr("--memory: 2 in the checkpoint, 1 now"));
    const Outcome resumed = testing::run_grainfield(run({"--resume"}));
    ASSERT_EQ(resumed.code, 0) << resumed.err;
    EXPECT_EQ(folder_.entries(), 1U);
    EXPECT_TRUE(timeless(folder_ / "t.h5") == expected);
}

TEST_F(TrackResume, BegunAnewOnlyByForce) {
    kill_after_checkpoint(run());
    const Outcome refused = testing::run_grainfield(run());
    EXPECT_EQ(refused.code, 4);
    EXPECT_TRUE(fs::exists(folder_ / "t.h5.checkpoint"));
    const Outcome explained = testing::run_grainfield(run({"--explain"}));
    EXPECT_EQ(explained.code, 0) << explained.err;
    EXPECT_TRUE(fs::exists(folder_ / "t.h5.checkpoint"));
    const Outcome forced = testing::run_grainfield(run({"--force"}));
    ASSERT_EQ(forced.code, 0) << forced.err;
    EXPECT_EQ(folder_.entries(), 1U);
    EXPECT_EQ(json::parse(forced.out)["frames"], 39) << "all but the damaged one";
}

TEST_F(TrackResume, ResumedWhenItIsCompleteItSaysSoAndRefusesOtherSettings) {
    ASSERT_EQ(testing::run_grainfield(run()).code, 0);
    const std::string before = testing::read_all(folder_ / "t.h5");
    const Outcome again = testing::run_grainfield(run({"--resume"}));
    EXPECT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out)["complete"], true);
    const Outcome other = testing::run_grainfield(run({"--resume", "--memory", "7"}));
    EXPECT_EQ(other.code, 3);
    EXPECT_THAT(other.err, HasSubstr("memory: 2 there, 7 now"));
    // They do not change positions, but stand in the output.
    const Outcome of_lab = testing::run_grainfield(run({"--resume", "--gamma", "4.7"}));
    EXPECT_EQ(of_lab.code, 3);
    EXPECT_THAT(of_lab.err, HasSubstr("4.7 now"));
    const Outcome as_well = testing::run_grainfield(run({"--resume", "--threads", "1"}));
    EXPECT_EQ(as_well.code, 0) << as_well.err;
    EXPECT_EQ(testing::read_all(folder_ / "t.h5"), before);
}

TEST_F(TrackResume, RefusesOtherPicturesUnderTheSameNames) {
    const Image white(testing::kPictureSize, testing::kPictureSize, 200);
    Image other = white;
    for (int y = 90; y < 100; ++y) other(60, y) = 0;
    for (const std::string option : {"--mask", "--flat-field", "--background"}) {
        const std::string name = film_ / (option.substr(2) + ".png");
        testing::write_png(name, white);
        const std::vector<std::string> words{option, name};
        kill_after_checkpoint(run(words));
        const std::string checkpoint = testing::read_all(folder_ / "t.h5.checkpoint");
        testing::write_png(name, other);
        const Outcome refused = testing::run_grainfield(run(with(words, {"--resume"})));
        EXPECT_EQ(refused.code, 3) << option << refused.err;
        EXPECT_THAT(refused.err, HasSubstr("content of '" + name + "'"));
        EXPECT_TRUE(testing::read_all(folder_ / "t.h5.checkpoint") == checkpoint);
        testing::write_png(name, white);
        const Outcome resumed = testing::run_grainfield(run(with(words, {"--resume"})));
        EXPECT_EQ(resumed.code, 0) << option << resumed.err;
        fs::remove(folder_ / "t.h5");
    }
}

TEST_F(TrackResume, RefusesAnotherFilmAndADamagedCheckpoint) {
    kill_after_checkpoint(run());
    std::vector<std::string> fewer = run({"--resume"});
    fewer.pop_back();
    const Outcome other = testing::run_grainfield(fewer);
    EXPECT_EQ(other.code, 3);
    EXPECT_THAT(other.err, HasSubstr("input: 40 files"));
    fs::resize_file(folder_ / "t.h5.checkpoint", 100);
    const Outcome damaged = testing::run_grainfield(run({"--resume"}));
    EXPECT_EQ(damaged.code, 3);
    EXPECT_THAT(damaged.err, HasSubstr("checkpoint"));
}

}  // namespace
}  // namespace grainfield
