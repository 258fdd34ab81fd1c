#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

class Configuration : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    std::vector<std::string> frames_ = testing::write_disc_sequence(folder_, 3);

    Outcome track(std::vector<std::string> words) {
        words.insert(words.begin(), "track");
        words.insert(words.end(), frames_.begin(), frames_.end());
        return run_grainfield(words);
    }

    std::string config(const std::string& text) {
        const std::string path = folder_ / "run.toml";
        std::ofstream(path) << text;
        return path;
    }

    json recorded(const std::string& output) {
        return json::parse(run_grainfield({"info", output, "--json"}).out)["configuration"];
    }
};

TEST_F(Configuration, TheFileSetsOptionsAndTheCommandLineWins) {
    const std::string output = folder_ / "tracks.h5";
    const std::string file =
        config("output = \"" + output + "\"\npreviews = 1\n[link]\nmemory = 5\nsearch-range = 3\n");
    const Outcome outcome = track({"-c", file, "--memory", "7"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json record = recorded(output);
    EXPECT_EQ(record["previews"], "1");
    EXPECT_EQ(record["link.memory"], "7");
    EXPECT_EQ(record["link.search-range"], "3");
    EXPECT_EQ(json::parse(run_grainfield({"info", output, "--json"}).out)["previews"], 1);
}

TEST_F(Configuration, HzAndMillimetresOfTheCommandLineWinOverGammaOfTheFile) {
    const std::string file = config("gamma = 4.5\n");
    const std::string output = folder_ / "tracks.h5";
    const Outcome outcome = track({"--json", "-o", output, "-c", file, "--vibration-frequency",
                                   "80", "--amplitude-mm", "0.1"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_NEAR(json::parse(outcome.out)["gamma"], 2.576, 1e-3);
    const std::string motion = config("vibration-frequency = 80\namplitude-mm = 0.1\n");
    const Outcome other = track({"--json", "-o", output, "--force", "-c", motion, "--gamma", "3"});
    ASSERT_EQ(other.code, 0) << other.err;
    EXPECT_EQ(json::parse(other.out)["gamma"], 3);
}

TEST_F(Configuration, TheTwoDiametersHaveNamesOfTheirOwnAndTheOldOneIsAccepted) {
    for (const char* name : {"--disc-diameter", "--diameter"}) {
        const std::string output = folder_ / "tracks.h5";
        const Outcome outcome = track({"-o", output, name, "11", "--force"});
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        EXPECT_EQ(recorded(output)["calibrate.disc-diameter"], "11");
    }
    const std::string file = config("[calibrate]\ndiameter = 12\n");
    ASSERT_EQ(track({"-o", folder_ / "tracks.h5", "-c", file, "--force"}).code, 0);
    EXPECT_EQ(recorded(folder_ / "tracks.h5")["calibrate.disc-diameter"], "12");
    for (const char* name : {"--sphere-diameter", "--diameter"}) {
        const Outcome outcome =
            run_grainfield({"analyze", folder_ / "tracks.h5", "-o", folder_ / "results.h5",
                            "--observables", "q4", name, "10", "--force", "--json"});
        ASSERT_EQ(outcome.code, 0) << outcome.err;
        const json lengths = json::parse(outcome.out)["lengths"]["measurements"];
        EXPECT_EQ(lengths[0]["value"], 10);
        EXPECT_EQ(lengths[0]["reason"], "given to analyze");
    }
}

TEST_F(Configuration, ExplainTellsThePlanAndWritesNothing) {
    const std::size_t before = folder_.entries();
    const Outcome words = track({"-o", folder_ / "tracks.h5", "--explain"});
    ASSERT_EQ(words.code, 0) << words.err;
    EXPECT_THAT(words.out, HasSubstr("run  detect"));
    const Outcome object = track({"-o", folder_ / "tracks.h5", "--explain", "--json"});
    EXPECT_TRUE(json::parse(object.out)["plan"].is_array());
    EXPECT_EQ(folder_.entries(), before);
}

TEST_F(Configuration, QuietPrintsNothingAndVerboseListsTheStages) {
    const Outcome quiet =
        track({"-o", folder_ / "a.h5", "--quiet", "--sphere-diameter", "10", "--fps", "25"});
    EXPECT_EQ(quiet.code, 0);
    EXPECT_EQ(quiet.out + quiet.err, "");
    const Outcome normal = track({"-o", folder_ / "b.h5"});
    EXPECT_THAT(normal.out, HasSubstr("particles per frame"));
    EXPECT_EQ(normal.out.find("run  detect"), std::string::npos);
    const Outcome verbose = track({"-o", folder_ / "c.h5", "-v"});
    EXPECT_THAT(verbose.out, HasSubstr("run  detect"));
}

TEST_F(Configuration, SkippedStagesAreSaidInTheSummaryAndInTheRecord) {
    const std::string output = folder_ / "one.h5";
    const Outcome outcome = run_grainfield({"track", frames_[0], "-o", output});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("skipped    link: one frame"));
    EXPECT_THAT(run_grainfield({"info", output}).out, HasSubstr("link: one frame"));
}

}  // namespace
}  // namespace grainfield
