#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::read_all;
using testing::run_grainfield;
using testing::ScratchFolder;

class Outputs : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    std::vector<std::string> frames_ = testing::write_disc_sequence(folder_, 1);
    std::string tracks_ = folder_ / "tracks.h5";
    std::string results_ = folder_ / "results.h5";

    void make_tracks_and_results() {
        ASSERT_EQ(run_grainfield({"track", frames_[0], "-o", tracks_}).code, 0);
        ASSERT_EQ(run_grainfield({"analyze", tracks_, "-o", results_}).code, 0);
    }
};

TEST_F(Outputs, ThatExistAreRefusedAndStayAsTheyAreUnlessForced) {
    make_tracks_and_results();
    std::ofstream(folder_ / "old.csv") << "old";
    std::ofstream(folder_ / "old.html") << "old";
    std::ofstream(folder_ / "old.h5") << "old";
    const std::vector<std::vector<std::string>> calls{
        {"track", frames_[0], "-o", folder_ / "old.h5"},
        {"analyze", tracks_, "-o", folder_ / "old.h5"},
        {"compare", results_, "-o", folder_ / "old.html"},
        {"export", tracks_, "-o", folder_ / "old.csv"}};
    for (std::vector<std::string> words : calls) {
        const std::string output = words.back();
        std::ofstream(output) << "old";
        const Outcome refused = run_grainfield(words);
        EXPECT_EQ(refused.code, 4) << words[0] << ": " << refused.err;
        EXPECT_THAT(refused.err, HasSubstr(output));
        EXPECT_THAT(refused.err, HasSubstr("--force"));
        EXPECT_EQ(read_all(output), "old");
        words.push_back("--force");
        const Outcome forced = run_grainfield(words);
        EXPECT_EQ(forced.code, 0) << forced.err;
        EXPECT_NE(read_all(output), "old");
    }
}

TEST_F(Outputs, ThatAreInputsAreRefused) {
    make_tracks_and_results();
    const std::string before = read_all(tracks_);
    for (const char* command : {"analyze", "export"}) {
        const Outcome outcome = run_grainfield({command, tracks_, "-o", tracks_, "--force"});
        EXPECT_EQ(outcome.code, 2);
        EXPECT_THAT(outcome.err, HasSubstr("is also an input"));
    }
    EXPECT_EQ(run_grainfield({"track", frames_[0], "-o", frames_[0], "--force"}).code, 2);
    EXPECT_EQ(read_all(tracks_), before);
}

TEST_F(Outputs, OfAFormThatDoesNotFitTheInputAreRefused) {
    make_tracks_and_results();
    EXPECT_EQ(run_grainfield({"export", tracks_, "-o", folder_ / "a.tif"}).code, 2);
    EXPECT_EQ(run_grainfield({"export", results_, "-o", folder_ / "a.csv"}).code, 2);
    EXPECT_EQ(run_grainfield({"export", frames_[0], "-o", folder_ / "a.csv"}).code, 3);
    EXPECT_EQ(run_grainfield({"compare", tracks_, "-o", folder_ / "a.html"}).code, 3);
    EXPECT_EQ(run_grainfield({"analyze", results_, "-o", folder_ / "a.h5"}).code, 3);
}

TEST_F(Outputs, OfASingleFrameAndOfAllCommandsLeaveNoTemporaryFiles) {
    make_tracks_and_results();
    ASSERT_EQ(run_grainfield({"compare", results_, "-o", folder_ / "r.html", "--no-figures"}).code,
              0);
    ASSERT_EQ(run_grainfield({"export", tracks_, "-o", folder_ / "t.csv"}).code, 0);
    // frame, tracks, results, page, points.
    EXPECT_EQ(folder_.entries(), 5U);
}

}  // namespace
}  // namespace grainfield
