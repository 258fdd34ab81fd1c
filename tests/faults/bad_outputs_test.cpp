// Cases 18 and 20 of docs/reliability.md: outputs that cannot be, or are there.
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::AnyOf;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

class BadOutput : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    ScratchFolder out_;
    std::vector<std::string> frames_ = testing::write_disc_sequence(folder_, 3);
    std::string tracks_ = folder_ / "tracks.h5";
    std::string results_ = folder_ / "results.h5";

    void SetUp() override {
        ASSERT_EQ(run_grainfield({"track", frames_[0], "-o", tracks_}).code, 0);
        ASSERT_EQ(run_grainfield({"analyze", tracks_, "-o", results_}).code, 0);
    }

    std::vector<std::vector<std::string>> calls_into(const std::string& folder) const {
        return {{"track", frames_[0], "-o", folder + "/t.h5"},
                {"analyze", tracks_, "-o", folder + "/r.h5"},
                {"compare", results_, "-o", folder + "/r.html"},
                {"export", tracks_, "-o", folder + "/x.csv"},
                {"export", results_, "-o", folder + "/curves"}};
    }
};

using Case18 = BadOutput;
using Case20 = BadOutput;

TEST_F(Case18, AFolderThatCannotBeWrittenOrIsNoneEndsWithFour) {
    std::ofstream(folder_ / "file") << "x";
    // /proc refuses new files even to root.
    const std::string missing = folder_ / "missing/deeper";
    for (const std::string& folder : {std::string("/proc"), folder_ / "file", missing}) {
        for (const auto& words : calls_into(folder)) {
            // Curves go into a folder that is made for them.
            if (folder == missing && words.back().ends_with("curves")) continue;
            const Outcome outcome = run_grainfield(words);
            EXPECT_EQ(outcome.code, 4) << words[0] << " into " << folder << ": " << outcome.err;
            EXPECT_THAT(outcome.err, HasSubstr(words.back())) << words[0];
            EXPECT_EQ(outcome.out, "");
        }
    }
}

TEST_F(BadOutput, ADirectoryUnderTheOutputNameIsRefusedEvenWithForce) {
    std::filesystem::create_directory(out_ / "t.h5");
    const Outcome outcome = run_grainfield({"track", frames_[0], "-o", out_ / "t.h5", "--force"});
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(out_ / "t.h5"));
    EXPECT_EQ(out_.entries(), 1U);
}

TEST_F(Case18, AFullDiskEndsWithFourAndNoPartialOutput) {
    // A limit of 8 blocks of 512 bytes on every file stands for the full disk: writes fail.
    for (const auto& words : calls_into(out_.path().string())) {
        if (words[0] == "export") continue;  // may fit
        std::string line = "trap '' XFSZ; ulimit -f 8; exec \"$GRAINFIELD\"";
        for (const std::string& word : words) line += " '" + word + "'";
        const Outcome outcome = testing::shell(line);
        EXPECT_EQ(outcome.code, 4) << words[0] << ": " << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(words.back())) << words[0];
    }
}

TEST_F(Case18, ALimitOnTheSizeOfFilesIsAFullDisk) {
    // Without a trap the system would end the process by SIGXFSZ, without a word.
    for (const auto& words : calls_into(out_.path().string())) {
        if (words[0] == "export") continue;  // may fit
        std::ofstream(words.back()) << "old";
        std::string line = "ulimit -f 8; exec \"$GRAINFIELD\"";
        for (const std::string& word : words) line += " '" + word + "'";
        const Outcome outcome = testing::shell(line + " --force");
        EXPECT_EQ(outcome.code, 4) << words[0] << ": " << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(out_.path().string())) << words[0];
        EXPECT_EQ(testing::read_all(words.back()), "old") << words[0];
    }
}

TEST_F(Case18, ALimitOnTheSizeOfFilesEndsSimulationsAndFilmsWithFour) {
    const std::string samples = GRAINFIELD_SOURCE_DIR "/data-samples/";
    const std::string layer = folder_ / "layer.h5";
    ASSERT_EQ(run_grainfield({"simulate", "md", "-c", samples + "demo-layer.toml", "--periods",
                              "60", "--discard", "50", "-o", layer})
                  .code,
              0);
    const std::vector<std::pair<std::string, std::string>> calls{
        {"simulate md -c '" + samples + "demo-layer.toml' --periods 60 --discard 50 -o", "md.h5"},
        {"simulate field --nx 128 --record 20 --relax 1 -o", "field.h5"},
        {"render '" + layer + "' -c '" + samples + "demo-camera.toml' --most-frames 1 -o", "f.avi"},
        {"export '" + tracks_ + "' --overlay", "overlay.mp4"}};
    for (const auto& [call, output] : calls) {
        const Outcome outcome = testing::shell("ulimit -f 8; exec \"$GRAINFIELD\" " + call + " '" +
                                               (out_ / output) + "'");
        EXPECT_EQ(outcome.code, 4) << call << ": " << outcome.err;
        EXPECT_FALSE(std::filesystem::exists(out_ / output)) << call;
    }
}

TEST_F(Case18, AFullDiskLeavesTheOldOutputIntact) {
    const std::string output = out_ / "t.h5";
    std::ofstream(output) << "old";
    const Outcome outcome = testing::shell(
        fmt::format("trap '' XFSZ; ulimit -f 8; exec \"$GRAINFIELD\" track '{}' -o '{}' --force",
                    frames_[0], output));
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    EXPECT_EQ(testing::read_all(output), "old");
}

TEST_F(Case20, OutputsThatExistAreRefusedAndStayAsTheyAreUnlessForced) {
    std::ofstream(out_ / "old.csv") << "old";
    std::ofstream(out_ / "old.html") << "old";
    std::ofstream(out_ / "old.h5") << "old";
    const std::vector<std::vector<std::string>> calls{
        {"track", frames_[0], "-o", out_ / "old.h5"},
        {"analyze", tracks_, "-o", out_ / "old.h5"},
        {"compare", results_, "-o", out_ / "old.html"},
        {"export", tracks_, "-o", out_ / "old.csv"}};
    for (std::vector<std::string> words : calls) {
        const std::string output = words.back();
        std::ofstream(output) << "old";
        const Outcome refused = run_grainfield(words);
        EXPECT_EQ(refused.code, 4) << words[0] << ": " << refused.err;
        EXPECT_THAT(refused.err, HasSubstr(output));
        EXPECT_THAT(refused.err, HasSubstr("--force"));
        EXPECT_EQ(testing::read_all(output), "old");
        words.push_back("--force");
        const Outcome forced = run_grainfield(words);
        EXPECT_EQ(forced.code, 0) << forced.err;
        EXPECT_NE(testing::read_all(output), "old");
    }
}

TEST_F(BadOutput, AFailureHalfWayLeavesNothingUnderTheFinalName) {
    testing::write_png(frames_[2], Image(64, 48, 200));
    const Outcome outcome =
        run_grainfield({"track", frames_[0], frames_[1], frames_[2], "-o", out_ / "t.h5"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_EQ(out_.entries(), 0U);
}

TEST_F(Case18, HelpThatCannotBeWrittenIsReported) {
    for (const char* words : {"--help", "--version", "track --help-all", "--man track"}) {
        const Outcome outcome =
            testing::shell(fmt::format("exec \"$GRAINFIELD\" {} > /dev/full", words));
        EXPECT_EQ(outcome.code, 4) << words;
        EXPECT_THAT(outcome.err, HasSubstr("standard output")) << words;
    }
}

TEST_F(Case18, ClosedStandardOutputIsReported) {
    const Outcome outcome =
        testing::shell(fmt::format("exec \"$GRAINFIELD\" info '{}' --json > /dev/full", tracks_));
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    EXPECT_THAT(outcome.err, AnyOf(HasSubstr("standard output"), HasSubstr("stream")));
}

}  // namespace
}  // namespace grainfield
