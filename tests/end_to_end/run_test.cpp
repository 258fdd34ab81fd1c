// `grainfield run`: one command from a film to its report.

#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

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
using testing::run_grainfield;
using testing::ScratchFolder;

std::string text_of(const fs::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

/// A film of five frames, run once for all cases.
class Run : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        scratch_ = new ScratchFolder;
        frames_ = testing::write_disc_sequence(*scratch_, 5);
        first_ = run({"--sphere-diameter", "11"});
    }
    static void TearDownTestSuite() { delete scratch_; }

    static std::string folder() { return *scratch_ / "out"; }
    static std::vector<std::string> words(const std::vector<std::string>& options,
                                          const std::string& folder_of,
                                          const std::vector<std::string>& frames) {
        std::vector<std::string> words{
            "run",   "--json", "--no-overlay", "--no-figures",
            "--fps", "25",     "-o",           folder_of.empty() ? folder() : folder_of};
        words.insert(words.end(), options.begin(), options.end());
        words.insert(words.end(), frames.begin(), frames.end());
        return words;
    }
    static Outcome run(const std::vector<std::string>& options, const std::string& folder_of = "") {
        return run_grainfield(words(options, folder_of, frames_));
    }
    static bool is_kept(const Outcome& outcome, const std::string& stage) {
        const json summary = json::parse(outcome.out);
        for (const json& one : summary["stages"]) {
            if (one["stage"] == stage) return one["kept"];
        }
        return false;
    }

    static inline ScratchFolder* scratch_ = nullptr;
    static inline std::vector<std::string> frames_;
    static inline Outcome first_;
};

TEST_F(Run, MakesTracksResultsReportAndOptions) {
    ASSERT_EQ(first_.code, 0) << first_.err;
    for (const char* name : {"tracks.h5", "results.h5", "report.html", "run.toml"}) {
        EXPECT_TRUE(fs::exists(fs::path(folder()) / name)) << name;
    }
    EXPECT_EQ(json::parse(first_.out)["frames"], 5);
    EXPECT_THAT(text_of(fs::path(folder()) / "report.html"), HasSubstr("spheres a frame"));
}

TEST_F(Run, AgainKeepsWhatIsDone) {
    const fs::path tracks = fs::path(folder()) / "tracks.h5";
    const auto before = fs::last_write_time(tracks);
    const Outcome again = run({"--sphere-diameter", "11"});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_TRUE(is_kept(again, "track"));
    EXPECT_TRUE(is_kept(again, "analyze"));
    EXPECT_EQ(fs::last_write_time(tracks), before);
}

TEST_F(Run, ThatFailsBeforeItHasWrittenAnythingLeavesNoFolder) {
    const ScratchFolder folder;
    const Outcome outcome =
        run_grainfield(words({"--height", "1.94"}, folder / "results", frames_));
    EXPECT_NE(outcome.code, 0) << "the height needs the true diameter";
    EXPECT_EQ(folder.entries(), 0U) << outcome.err;
}

TEST_F(Run, TracksThatWereCutOffDoNotPassForDone) {
    const std::string cut = *scratch_ / "cut";
    const ScratchFolder film;
    const std::vector<std::string> frames = testing::write_disc_sequence(film, 60);
    Outcome outcome;
    for (int wait = 600; wait > 1; wait = wait * 2 / 3) {
        const testing::Process process(testing::program(words({}, cut, frames)));
        process.let_work(std::chrono::milliseconds(wait), SIGINT);
        process.send(SIGINT);
        outcome = process.wait();
        // Cut off in tracking, and not later.
        if (outcome.code == 130 && fs::exists(fs::path(cut) / "tracks.h5.checkpoint")) break;
        fs::remove_all(cut);
    }
    ASSERT_EQ(outcome.code, 130) << outcome.err;
    // As when it was stuck in its first minutes: some frames, and nothing to go on from.
    fs::remove(fs::path(cut) / "tracks.h5.checkpoint");
    fs::remove(fs::path(cut) / "tracks.h5.snapshots");
    const Outcome again = run_grainfield(words({}, cut, frames));
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_FALSE(is_kept(again, "track"));
    EXPECT_EQ(json::parse(again.out)["frames"], 60);
}

TEST_F(Run, WithOtherOptionsOfTheAnalysisKeepsTheTracksAlone) {
    const Outcome other = run({"--sphere-diameter", "11", "--solid-above", "0.8"});
    ASSERT_EQ(other.code, 0) << other.err;
    EXPECT_TRUE(is_kept(other, "track"));
    EXPECT_FALSE(is_kept(other, "analyze"));
}

TEST_F(Run, DoesNotReplaceTracksOfOtherOptionsUnlessTold) {
    const Outcome refused = run({"--sphere-diameter", "12"});
    EXPECT_EQ(refused.code, 4);
    EXPECT_THAT(refused.err, HasSubstr("sphere-diameter is 12, was 11"));
    EXPECT_THAT(refused.err, HasSubstr("--force"));
}

TEST_F(Run, DoesNotKeepTracksOfAnotherMaskOfTheSameName) {
    const ScratchFolder masks;
    const ScratchFolder out;
    const std::string mask = masks / "mask.png";
    Image visible(testing::kPictureSize, testing::kPictureSize, 1);
    testing::write_png(mask, visible);
    ASSERT_EQ(run({"--sphere-diameter", "11", "--mask", mask}, out / "m").code, 0);
    EXPECT_TRUE(is_kept(run({"--sphere-diameter", "11", "--mask", mask}, out / "m"), "track"));
    for (int y = 0; y < testing::kPictureSize; ++y) visible(0, y) = 0;
    testing::write_png(mask, visible);
    const Outcome other = run({"--sphere-diameter", "11", "--mask", mask}, out / "m");
    EXPECT_NE(other.code, 0);
    EXPECT_THAT(other.err, HasSubstr("mask.png"));
    EXPECT_FALSE(
        is_kept(run({"--sphere-diameter", "11", "--mask", mask, "--force"}, out / "m"), "track"));
}

TEST_F(Run, UnitsOfTheLabAreThoseThatTheTracksHold) {
    for (const std::vector<std::string>& later :
         {std::vector<std::string>{"--vibration-frequency", "80"},
          {"--sphere-mm", "1"},
          {"--amplitude-mm", "0.1"},
          {"--gamma", "4.7"}}) {
        std::vector<std::string> options{"--sphere-diameter", "11"};
        options.insert(options.end(), later.begin(), later.end());
        const Outcome refused = run(options);
        EXPECT_EQ(refused.code, 4) << refused.out;
        EXPECT_THAT(refused.err, HasSubstr(later[0] + " is " + later[1] + ", was not given"));
        EXPECT_THAT(refused.err, HasSubstr("--force"));
    }
    const std::string lab = *scratch_ / "lab";
    const std::vector<std::string> given{"--sphere-diameter",     "11", "--sphere-mm",    "1",
                                         "--vibration-frequency", "80", "--amplitude-mm", "0.1"};
    ASSERT_EQ(run(given, lab).code, 0);
    const Outcome same = run(given, lab);
    ASSERT_EQ(same.code, 0) << same.err;
    EXPECT_TRUE(is_kept(same, "track"));
    EXPECT_TRUE(is_kept(same, "analyze"));
    const std::string results = fs::path(lab) / "results.h5";
    const json info = json::parse(run_grainfield({"info", results, "--json"}).out);
    EXPECT_EQ(info["sphere_mm"], 1);
    EXPECT_EQ(info["vibration"], "Γ = 2.576, 80 Hz");
    EXPECT_THAT(std::string(info["label"]), ::testing::EndsWith(", Γ = 2.576"));
    EXPECT_THAT(text_of(fs::path(lab) / "report.html"), HasSubstr("vibration 80 Hz, Γ = 2.576"));
    const Outcome other = run({"--sphere-diameter", "11", "--sphere-mm", "2"}, lab);
    EXPECT_EQ(other.code, 4);
    EXPECT_THAT(other.err, HasSubstr("--sphere-mm is 2, was 1"));
    std::vector<std::string> silent = words({"--sphere-diameter", "11"}, lab, frames_);
    std::erase(silent, "--json");
    const Outcome again = run_grainfield(silent);
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_THAT(again.out, HasSubstr("results.h5 (kept)"));
    EXPECT_THAT(again.out, HasSubstr("spheres of 1 mm"));
    EXPECT_THAT(again.out, HasSubstr("Γ = 2.576, 80 Hz, 0.1 mm"));
}

TEST_F(Run, TakesItsOptionsFromTheFileOfTheLastOne) {
    const std::string options = fs::path(folder()) / "run.toml";
    ASSERT_THAT(text_of(options), HasSubstr("sphere-diameter = 11"));
    std::vector<std::string> words{"run", "--json", "-c", options, "-o", *scratch_ / "second"};
    words.insert(words.end(), frames_.begin(), frames_.end());
    const Outcome second = run_grainfield(words);
    ASSERT_EQ(second.code, 0) << second.err;
    EXPECT_FALSE(fs::exists(fs::path(*scratch_ / "second") / "overlay.mp4")) << "as in the file";
    const auto without_heading = [](const std::string& text) {
        return text.substr(text.find("\n\n"));
    };
    EXPECT_EQ(without_heading(text_of(fs::path(*scratch_ / "second") / "run.toml")),
              without_heading(text_of(options)));
}

}  // namespace
}  // namespace grainfield
