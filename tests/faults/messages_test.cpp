// Also cases 18 and 19 of docs/reliability.md. What is said when something is wrong names the file,
// and is safe to print.
#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/md_words.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::Process;
using testing::program;
using testing::ScratchFolder;
using testing::with;

TEST(Messages, OfAnErrorInAnInputNameIt) {
    const ScratchFolder folder;
    const std::string points = folder / "points.csv";
    std::ofstream(points) << "frame,particle,x,y\n0,0,1,2\n0,1,3,4\n1,0,1,2\n1,1,3,4\n";
    const Outcome outcome =
        testing::run_grainfield({"analyze", points, "-o", folder / "r.h5", "--box", "10,10",
                                 "--diameter", "1", "--sk-k-max", "1e6"});
    ASSERT_NE(outcome.code, 0);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("S(k)"), HasSubstr(points)));
    const std::string frame = testing::write_disc_sequence(folder, 1)[0];
    const Outcome range =
        testing::run_grainfield({"track", frame, "-o", folder / "t.h5", "--frames", "7:9"});
    ASSERT_NE(range.code, 0);
    EXPECT_THAT(range.err, HasSubstr(frame));
}

TEST(Messages, OfAWrongOptionNameTheConfiguration) {
    const ScratchFolder folder;
    const std::string file = folder / "small.toml";
    std::ofstream(file) << "[cell]\ngrains = 5\nlength-x = 1.5\n";
    const Outcome outcome =
        testing::run_grainfield({"simulate", "md", "-c", file, "-o", folder / "a.h5"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("--length-x cannot be simulated"), HasSubstr(file)));
}

// The first run has made a checkpoint by then; it is not interrupted.
TEST(Case19, ASecondWriterIsRefusedAndNotToldOfAnInterruptedRun) {
    const ScratchFolder folder;
    const std::vector<std::string> job{
        "simulate",           "field", "--nx", "256",          "--record", "1e5",
        "--checkpoint-every", "0.05",  "-o",   folder / "x.h5"};
    const Process first(program(job));
    first.let_write(folder / "x.h5.checkpoint");
    const Outcome second = testing::run_grainfield(job);
    EXPECT_EQ(second.code, 4);
    EXPECT_THAT(second.err,
                AllOf(HasSubstr("another run is writing it"), Not(HasSubstr("interrupted"))));
    const Outcome forced = testing::run_grainfield(
        {"simulate", "field", "--nx", "64", "--record", "10", "--force", "-o", folder / "x.h5"});
    EXPECT_EQ(forced.code, 4) << "--force does not take the file from a run that writes it";
    EXPECT_THAT(forced.err, HasSubstr("another run is writing it"));
    first.send(SIGTERM);
    EXPECT_EQ(first.wait().code, 143);
    const Outcome third = testing::run_grainfield(job);
    EXPECT_THAT(third.err, HasSubstr("an interrupted run")) << "now it is one";
}

TEST(Messages, OfTruthAndOutputOfOneNameSaySo) {
    const ScratchFolder folder;
    const std::string file = folder / "md.h5";
    ASSERT_EQ(testing::run_grainfield(with(testing::md_words("20", "8"),
                                           {"--periods", "1", "--snapshot-every", "1", "-o", file}))
                  .code,
              0);
    const std::string same = folder / "x.avi";
    const Outcome outcome = testing::run_grainfield({"render", file, "-o", same, "--truth", same});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("--truth"), HasSubstr(same)));
}

TEST(Messages, OfPositionsGivenAsAFilmSayWhatTheyAre) {
    const ScratchFolder folder;
    const std::string points = folder / "points.csv";
    std::ofstream(points) << "frame,x,y\n0,1,2\n";
    const Outcome film =
        testing::run_grainfield({"track", points, "-o", folder / "t.h5", "--fps", "25"});
    EXPECT_EQ(film.code, 3);
    EXPECT_THAT(film.err, AllOf(HasSubstr(points), HasSubstr("a list of points"),
                                HasSubstr("a video or images"), HasSubstr("analyze")));
    const std::string frame = testing::write_disc_sequence(folder, 1)[0];
    const Outcome truth =
        testing::run_grainfield({"validate", frame, points, "-o", folder / "v.html"});
    EXPECT_EQ(truth.code, 2);
    EXPECT_THAT(truth.err, AllOf(HasSubstr(points), HasSubstr("--truth")));
}

TEST(Messages, TwoHyphensEndTheOptions) {
    const ScratchFolder folder;
    const std::string points = folder / "points.csv";
    std::ofstream(points) << "frame,x,y\n0,1,2\n";
    const Outcome outcome = testing::run_grainfield({"info", "--json", "--", points});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    const Outcome odd = testing::run_grainfield({"info", "--", "--points.csv"});
    EXPECT_EQ(odd.code, 3) << "the name of a file: " << odd.err;
    EXPECT_THAT(odd.err, HasSubstr("--points.csv"));
}

// libtiff spoke for itself.
TEST(Case18, MessagesOfAFullDiskAreOnesOfTheProgram) {
    const ScratchFolder folder;
    ASSERT_EQ(testing::run_grainfield(
                  with(testing::md_words("20", "8"),
                       {"--periods", "1", "--snapshot-every", "1", "-o", folder / "md.h5"}))
                  .code,
              0);
    const Outcome outcome =
        testing::shell("ulimit -f 20; $GRAINFIELD render " + (folder / "md.h5") + " -o " +
                       (folder / "frames") + " --format tiff");
    EXPECT_EQ(outcome.code, 4) << outcome.err;
    for (std::size_t at = 0; at < outcome.err.size();) {
        const std::size_t end = std::min(outcome.err.find('\n', at), outcome.err.size());
        EXPECT_THAT(outcome.err.substr(at, end - at), ::testing::MatchesRegex("(error|warning).*"));
        at = end + 1;
    }
}

}  // namespace
}  // namespace grainfield
