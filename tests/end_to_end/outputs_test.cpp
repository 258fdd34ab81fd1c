#include <filesystem>
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

using ::testing::AllOf;
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

TEST_F(Outputs, ThatCannotBeWrittenAreRefusedBeforeTheInputIsRead) {
    make_tracks_and_results();
    // The input would be refused with 3: the output is looked at first.
    std::ofstream(folder_ / "damaged.h5") << "\x89HDF\r\n\x1a\n and nothing more";
    std::ofstream(folder_ / "damaged.png") << "\x89PNG\r\n\x1a\n and nothing more";
    std::ofstream(folder_ / "old.h5") << "old";
    EXPECT_EQ(run_grainfield({"track", folder_ / "damaged.png", "-o", folder_ / "old.h5"}).code, 4);
    std::ofstream(folder_ / "points.csv") << "frame,x,y\nnothing\n";
    EXPECT_EQ(run_grainfield({"analyze", folder_ / "points.csv", "-o", folder_ / "old.h5"}).code,
              4);
    EXPECT_EQ(read_all(folder_ / "old.h5"), "old");
}

TEST_F(Outputs, OfTracksUnderTheNameOfAPictureAreRefused) {
    const Outcome outcome = run_grainfield({"track", frames_[0], "-o", folder_ / "x.tif"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("x.h5"));
    EXPECT_EQ(run_grainfield({"track", frames_[0], "-o", folder_ / "x.hdf5"}).code, 0);
}

TEST_F(Outputs, OfTracksSayThatLengthsAreInApparentDiametersUnlessTheSizeIsGiven) {
    make_tracks_and_results();
    const char* words = "lengths are in apparent disc diameters D";
    EXPECT_THAT(run_grainfield({"info", tracks_}).out, HasSubstr(words));
    EXPECT_THAT(run_grainfield({"info", results_}).out, HasSubstr(words));
    const Outcome given =
        run_grainfield({"track", frames_[0], "-o", folder_ / "g.h5", "--sphere-diameter", "10"});
    EXPECT_EQ(given.err.find(words), std::string::npos) << given.err;
}

TEST_F(Outputs, OfABlackFrameAreRefusedAndSayWhy) {
    testing::write_png(folder_ / "black.png", Image(64, 64));
    const Outcome outcome =
        run_grainfield({"track", folder_ / "black.png", "-o", folder_ / "b.h5", "--json"});
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("no spheres to track"));
    EXPECT_THAT(outcome.err, HasSubstr("no contrast"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "b.h5"));
}

TEST_F(Outputs, OfAPeriodicTableNeedItsBox) {
    std::ofstream(folder_ / "p.csv") << "frame,x,y\n0,1,1\n0,2,3\n0,4,4\n";
    const Outcome guessed = run_grainfield({"analyze", folder_ / "p.csv", "-o", folder_ / "p.h5",
                                            "--boundary", "periodic", "--diameter", "1"});
    EXPECT_EQ(guessed.code, 2);
    EXPECT_THAT(guessed.err, HasSubstr("--box LX,LY"));
    EXPECT_EQ(run_grainfield({"analyze", folder_ / "p.csv", "-o", folder_ / "p.h5", "--boundary",
                              "periodic", "--box", "5,5", "--diameter", "1"})
                  .code,
              0);
}

TEST_F(Outputs, OfATableWithoutUnitsNeedTheDiameterOfAParticle) {
    std::ofstream(folder_ / "p.csv") << "frame,x,y\n0,10,10\n0,20,30\n0,40,40\n";
    const std::vector<std::string> call{"analyze", folder_ / "p.csv", "-o", folder_ / "p.h5",
                                        "--json",  "--observables",   "q4"};
    const Outcome silent = run_grainfield(call);
    EXPECT_EQ(silent.code, 2);
    EXPECT_THAT(silent.err, AllOf(HasSubstr("p.csv"), HasSubstr("--sphere-diameter")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "p.h5"));
    const Outcome given = run_grainfield(testing::with(call, {"--sphere-diameter", "10"}));
    ASSERT_EQ(given.code, 0) << given.err;
    const auto lengths = nlohmann::json::parse(given.out)["lengths"];
    EXPECT_EQ(lengths["value"], 10);
    EXPECT_EQ(lengths["reason"], "given to analyze");
    const Outcome info = run_grainfield({"info", folder_ / "p.csv"});
    EXPECT_THAT(info.out, HasSubstr("not stated")) << "and no diameter of 1 is made up";
}

TEST_F(Outputs, AreAskedForInWordsWhereTheInputIsMissing) {
    const Outcome outcome = run_grainfield({"track", "-o", folder_ / "x.h5"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("at least one VIDEO|IMAGE"));
    const Outcome help = run_grainfield({"compare", "--help"});
    EXPECT_EQ(help.code, 0);
    EXPECT_EQ(help.out.find("{false}"), std::string::npos);
}

TEST_F(Outputs, GoToStandardOutputAsCsvOrJsonAndNothingElseDoes) {
    make_tracks_and_results();
    ASSERT_EQ(run_grainfield({"export", tracks_, "-o", folder_ / "table.csv"}).code, 0);
    const std::size_t files = folder_.entries();
    const Outcome table = run_grainfield({"export", tracks_, "-o", "-"});
    EXPECT_EQ(table.code, 0) << table.err;
    EXPECT_EQ(table.out, read_all(folder_ / "table.csv"));
    const Outcome curves = run_grainfield({"export", results_, "-o", "-"});
    EXPECT_EQ(curves.code, 0) << curves.err;
    const auto all = nlohmann::json::parse(curves.out);
    EXPECT_EQ(all["sk"]["sk"]["k"].size(), all["sk"]["sk"]["s"].size());
    EXPECT_GT(all["sk"]["sk"]["k"].size(), 3U);
    EXPECT_EQ(folder_.entries(), files) << "no file";
    for (const char* command :
         {"track", "analyze", "compare", "link", "tune", "validate", "render", "run"}) {
        const Outcome refused = run_grainfield({command, tracks_, "-o", "-"});
        EXPECT_EQ(refused.code, 2) << command;
        EXPECT_THAT(refused.err, HasSubstr("cannot go to standard output")) << command;
    }
    for (const char* model : {"md", "field"}) {
        const Outcome refused = run_grainfield({"simulate", model, "-o", "-"});
        EXPECT_EQ(refused.code, 2) << model;
        EXPECT_THAT(refused.err, HasSubstr("cannot go to standard output")) << model;
    }
    EXPECT_EQ(run_grainfield({"export", tracks_, "-o", "-", "--json"}).code, 2);
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
    // frame, tracks, results, page, points and their units.
    EXPECT_EQ(folder_.entries(), 6U);
    EXPECT_TRUE(std::filesystem::exists(folder_ / "t.csv.meta"));
}

TEST_F(Outputs, OverlayFindsTheFilmFromAnotherFolderAndFailsWhereItIsGone) {
    const std::vector<std::string> film = testing::write_disc_sequence(folder_, 4);
    std::vector<std::string> words{"track", "-o", tracks_};
    words.insert(words.end(), film.begin(), film.end());
    ASSERT_EQ(run_grainfield(words).code, 0);
    const std::string video = folder_ / "overlay.mp4";
    const Outcome drawn = run_grainfield({"export", tracks_, "--overlay", video, "--json"});
    EXPECT_EQ(drawn.code, 0) << drawn.err;
    EXPECT_THAT(drawn.out, HasSubstr("\"frames\": 4"));
    EXPECT_THAT(drawn.out, ::testing::Not(HasSubstr("without the film")));
    EXPECT_EQ(read_all(video).substr(4, 4), "ftyp") << "an MP4 file";

    // The record says frame_000.png; another folder has none.
    const std::string here = folder_.path().string();
    ASSERT_EQ(testing::shell("cd '" + here + "' && $GRAINFIELD track --force frame_*.png -o '" +
                             tracks_ + "'")
                  .code,
              0);
    const Outcome away = testing::shell("cd / && $GRAINFIELD export --force '" + tracks_ +
                                        "' --overlay '" + video + "'");
    EXPECT_EQ(away.code, 0) << away.err;
    EXPECT_THAT(away.out, ::testing::Not(HasSubstr("without the film")));
    for (const char* colour : {"speed", "phase"}) {
        EXPECT_EQ(
            run_grainfield({"export", tracks_, "--overlay", video, "--force", "--colour", colour})
                .code,
            0);
    }
    const Outcome layers =
        run_grainfield({"export", tracks_, "--overlay", video, "--force", "--colour", "layer"});
    EXPECT_EQ(layers.code, 3) << "they are not known";

    // Another film of the same names and sizes.
    std::string bytes = read_all(film[0]);
    bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
    std::ofstream(film[0], std::ios::binary) << bytes;
    const Outcome other = run_grainfield({"export", tracks_, "--overlay", video, "--force"});
    EXPECT_EQ(other.code, 3);
    EXPECT_THAT(other.err, ::testing::AllOf(HasSubstr("its content is another"),
                                            HasSubstr("recorded checksum")));

    for (const std::string& frame : film) std::filesystem::remove(frame);
    const Outcome gone = run_grainfield({"export", tracks_, "--overlay", video, "--force"});
    EXPECT_EQ(gone.code, 3);
    EXPECT_THAT(gone.err, ::testing::AllOf(HasSubstr("is not there"), HasSubstr("--film")));
    const Outcome white =
        run_grainfield({"export", tracks_, "--overlay", video, "--force", "--film", "none"});
    EXPECT_EQ(white.code, 0) << white.err;
    EXPECT_THAT(white.out, HasSubstr("without the film"));
    EXPECT_EQ(run_grainfield({"export", tracks_, "--overlay", folder_ / "o.gif"}).code, 2);
    EXPECT_EQ(run_grainfield({"export", tracks_, "--overlay", video, "--film", "none"}).code, 4)
        << "it exists";
    EXPECT_EQ(run_grainfield({"export", tracks_, "--overlay", video, "-o", folder_ / "x.csv"}).code,
              2);
}

}  // namespace
}  // namespace grainfield
