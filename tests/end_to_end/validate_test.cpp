// `grainfield validate` on frames that exist: scores for scripts, thresholds, exit codes.
#include <chrono>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

constexpr int kFrames = 4;

/// Frames of discs that drift, and where they are.
class GivenFrames : public ::testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = new ScratchFolder;
        frames_ = testing::write_disc_sequence(*folder_, kFrames);
        std::ofstream truth(*folder_ / "truth.csv");
        truth << "frame,particle,x,y\n";
        const testing::LayerScene start = testing::few_discs();
        for (int f = 0; f < kFrames; ++f) {
            for (std::size_t i = 0; i < start.position.size(); ++i) {
                const Vec2 p = start.position[i] + Vec2{0.3, -0.2} * f;
                truth << fmt::format("{},{},{:.6f},{:.6f}\n", f, i, p.x, p.y);
            }
        }
    }
    static void TearDownTestSuite() { delete folder_; }

    static Outcome validate(const std::string& output, std::vector<std::string> more) {
        std::vector<std::string> words{"validate", "--truth",         *folder_ / "truth.csv",
                                       "-o",       *folder_ / output, "--sphere-diameter",
                                       "10"};
        words.insert(words.end(), frames_.begin(), frames_.end());
        words.insert(words.end(), more.begin(), more.end());
        return run_grainfield(words);
    }

    static inline ScratchFolder* folder_ = nullptr;
    static inline std::vector<std::string> frames_;
};

TEST_F(GivenFrames, AreScoredWithTheKeysThatScriptsRelyOn) {
    const Outcome outcome = validate("a.html", {"--json", "--no-figures"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json summary = json::parse(outcome.out);
    EXPECT_EQ(summary["frames"], kFrames);
    EXPECT_EQ(summary["recall"], 1);
    EXPECT_EQ(summary["precision"], 1);
    // 2 % noise, D = 9, w = 1.25: 480 discs scatter by 3 %, rounding to 8 bits adds 1 %.
    EXPECT_GT(summary["bound_ratio"], 0.88);
    EXPECT_LT(summary["bound_ratio"], 1.15);
    for (const char* name : {"all", "isolated", "liquid", "crystal", "top", "bottom", "border"}) {
        const json& scores = summary["classes"][name];
        for (const char* key :
             {"recall", "precision", "rmse_px", "bound_ratio", "pull_rms", "within_2_sigma"}) {
            EXPECT_TRUE(scores.contains(key)) << name << " " << key;
        }
    }
    EXPECT_TRUE(summary["classes"]["top"]["recall"].is_null()) << "no layers are known";
    // 5 sigma of a share of 960 coordinates.
    EXPECT_NEAR(summary["classes"]["all"]["within_2_sigma"], 0.954, 0.034);
    EXPECT_TRUE(summary["layers_named"].is_null());
    EXPECT_EQ(summary["tracks"]["switches"], 0);
    EXPECT_EQ(summary["tracks"]["jsc_theta"], 1);
    EXPECT_TRUE(summary["thresholds"].empty());
    EXPECT_THAT(testing::read_all(*folder_ / "a.html"), HasSubstr("Positions, by class"));
}

TEST_F(GivenFrames, EndWithExitCodeFiveWhenAThresholdIsMissedAndStillGiveTheReport) {
    const Outcome met = validate("b.html", {"--recall", "1", "--bound-ratio", "1.5"});
    EXPECT_EQ(met.code, 0) << met.err;
    const Outcome missed = validate("c.html", {"--recall", "1", "--rmse", "1e-4", "--json"});
    EXPECT_EQ(missed.code, 5);
    EXPECT_THAT(missed.err, HasSubstr("thresholds missed: rmse 0.0"));
    EXPECT_THAT(missed.err, HasSubstr("at most 0.0001 asked for"));
    const json summary = json::parse(missed.out);
    ASSERT_EQ(summary["thresholds"].size(), 2U);
    EXPECT_EQ(summary["thresholds"][0]["met"], true);
    EXPECT_EQ(summary["thresholds"][1]["met"], false);
    EXPECT_THAT(testing::read_all(*folder_ / "c.html"), HasSubstr("failed\">missed"));
    EXPECT_TRUE(std::filesystem::exists(*folder_ / "c_files/scores.csv"));
}

TEST_F(GivenFrames, OneAloneNeedsNeitherFramesNorIdentitiesInItsTruth) {
    std::ofstream table(*folder_ / "one.csv");
    table << "x_px,y_px\n";
    for (const Vec2 p : testing::few_discs().position) {
        table << fmt::format("{:.6f},{:.6f}\n", p.x, p.y);
    }
    table.close();
    const Outcome outcome = run_grainfield({"validate", frames_[0], "--truth", *folder_ / "one.csv",
                                            "-o", *folder_ / "one.html", "--no-figures"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("one.html: 1 frame\n"));
    EXPECT_THAT(outcome.out, HasSubstr("1.00000    1.00000"));
    EXPECT_THAT(outcome.out, Not(HasSubstr("nan")));
    EXPECT_THAT(outcome.out, Not(HasSubstr("tracks")));
}

TEST_F(GivenFrames, AreScoredWithACalibrationThatWasKept) {
    std::vector<std::string> words{"track",
                                   "-o",
                                   *folder_ / "kept.h5",
                                   "--save-calibration",
                                   *folder_ / "kept.toml",
                                   "--sphere-diameter",
                                   "10"};
    words.insert(words.end(), frames_.begin(), frames_.end());
    ASSERT_EQ(run_grainfield(words).code, 0);
    const Outcome kept =
        validate("kept.html", {"--json", "--no-figures", "--calibration", *folder_ / "kept.toml"});
    ASSERT_EQ(kept.code, 0) << kept.err;
    EXPECT_EQ(json::parse(kept.out)["recall"], 1);
    EXPECT_THAT(kept.out, HasSubstr("kept from another run"));
    const Outcome twice =
        validate("twice.html", {"--calibration", *folder_ / "kept.toml", "--diameter", "9"});
    EXPECT_EQ(twice.code, 2) << "one of them";
}

TEST_F(GivenFrames, MustComeWithATruthThatBelongsToThem) {
    const Outcome without = run_grainfield({"validate", frames_[0], "-o", *folder_ / "d.html"});
    EXPECT_EQ(without.code, 2);
    EXPECT_THAT(without.err, HasSubstr("--truth"));
    const Outcome other = run_grainfield({"validate", frames_[0], frames_[1], "--truth",
                                          *folder_ / "truth.csv", "-o", *folder_ / "d.html"});
    EXPECT_EQ(other.code, 3);
    EXPECT_THAT(other.err, HasSubstr("4 snapshots; expected 2, one a frame"));
    std::ofstream(*folder_ / "anonymous.csv") << "frame,x,y\n0,20,20\n1,20,20\n2,20,20\n3,20,20\n";
    std::vector<std::string> words{"validate", "--truth", *folder_ / "anonymous.csv", "-o",
                                   *folder_ / "d.html"};
    words.insert(words.end(), frames_.begin(), frames_.end());
    const Outcome anonymous = run_grainfield(words);
    EXPECT_EQ(anonymous.code, 3);
    EXPECT_THAT(anonymous.err, HasSubstr("the truth of frame 0 has no identities"));
    EXPECT_FALSE(std::filesystem::exists(*folder_ / "d.html"));
}

/// Seconds of a whole chain: 430 grains, 8 frames.
std::vector<std::string> small_scene(const std::string& output) {
    return {"validate", "-o",         output, "--grains",
            "430",      "--length-x", "21",   "--length-y",
            "21",       "--width",    "300",  "--view-height",
            "300",      "--scale",    "14",   "--periods",
            "2.8",      "--discard",  "2",    "--snapshot-every",
            "0.1"};
}

TEST(ValidateScene, GoesFromMolecularDynamicsToScores) {
    const ScratchFolder folder;
    std::vector<std::string> words = small_scene(folder / "a.html");
    words.insert(words.end(), {"--json", "--recall", "0.99", "--precision", "0.99"});
    const Outcome outcome = run_grainfield(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json summary = json::parse(outcome.out);
    EXPECT_EQ(summary["frames"], 9);
    EXPECT_GT(summary["classes"]["crystal"]["matched"], 100);
    EXPECT_GT(summary["classes"]["liquid"]["matched"], 500);
    EXPECT_GT(summary["classes"]["border"]["matched"], 100);
    EXPECT_GT(summary["classes"]["top"]["matched"], 300);
    EXPECT_GT(summary["tracks"]["correct_links"], 0.98);
    EXPECT_TRUE(summary["downstream"]["q4_mean"]["true"].is_number());
    EXPECT_TRUE(summary["downstream"]["s_low_k"]["tracked"].is_number());
    EXPECT_TRUE(std::filesystem::exists(folder / "a_files/downstream.csv"));
}

TEST(ValidateScene, RayTracedShowsItsProgressAndItsPrice) {
    const ScratchFolder folder;
    std::vector<std::string> words = small_scene(folder / "a.html");
    for (std::string& word : words) {
        if (word == "300") word = "130";  // px
        if (word == "2.8") word = "2.1";  // two frames
    }
    words.insert(words.end(), {"--json", "--optics", "raytrace", "--no-figures"});
    const Outcome outcome = run_grainfield(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("rendering, tracking and scoring 0/2 frames"));
    const json summary = json::parse(outcome.out);
    EXPECT_EQ(summary["frames"], 2);
    EXPECT_GT(summary["recall"], 0.9);
    EXPECT_GT(summary["rays_per_pixel"], 5);
    EXPECT_GT(summary["rays_saved"], 0.1);
    EXPECT_LT(summary["sampling_difference"], 1.5 * summary["camera_noise"].get<double>());
}

TEST(ValidateScene, GivesTheSameScoresForAnyNumberOfThreads) {
    const ScratchFolder folder;
    std::vector<std::string> scores;
    for (const char* threads : {"1", "3"}) {
        std::vector<std::string> words = small_scene(folder / (std::string(threads) + ".html"));
        words.insert(words.end(), {"--threads", threads});
        const Outcome outcome = run_grainfield(words);
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        scores.push_back(testing::read_all(folder / (std::string(threads) + "_files/scores.csv")) +
                         testing::read_all(folder / (std::string(threads) + "_files/sk.csv")));
    }
    EXPECT_EQ(scores[0], scores[1]);
}

TEST(ValidateScene, ExplainsWithoutRunning) {
    const Outcome outcome = run_grainfield({"validate", "--explain"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("silhouettes, 1600"));
    EXPECT_THAT(outcome.out, HasSubstr("score"));
}

TEST(ValidateScene, StopsAtCtrlCWithTheScoresOfTheFramesDone) {
    const ScratchFolder folder;
    std::vector<std::string> words = small_scene(folder / "a.html");
    for (std::string& word : words) {
        if (word == "2.8") word = "40";
    }
    words.insert(words.begin(), GRAINFIELD_PROGRAM);
    const testing::Process process(words);
    // 380 frames take far longer than this, the molecular dynamics far less.
    process.let_work(std::chrono::seconds(4), SIGINT);
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("interrupted after"));
    EXPECT_THAT(testing::read_all(folder / "a.html"), HasSubstr("Positions, by class"));
}

}  // namespace
}  // namespace grainfield
