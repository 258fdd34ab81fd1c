#include "app/tune_command.h"

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::app {
namespace {

TEST(TrackCommandLine, SpellsSettingsAsTrackTakesThem) {
    EXPECT_EQ(track_command_line({{"track", "background-window", "400"},
                                  {"track", "mask", "\"m.png\""},
                                  {"track", "strict", "true"},
                                  {"calibrate", "disc-diameter", "21.500"}},
                                 {"film.avi"}),
              "grainfield track 'film.avi' -o tracks.h5 --background-window 400 --mask 'm.png' "
              "--strict --disc-diameter 21.500");
}

TEST(TrackCommandLine, IsReadByAShellAsItWasTyped) {
    EXPECT_EQ(track_command_line({{"track", "mask", "\"a \\\"b\\\" it's.png\""}},
                                 {"frames/*.tif", "it's.avi"}),
              "grainfield track 'frames/*.tif' 'it'\\''s.avi' -o tracks.h5 "
              "--mask 'a \"b\" it'\\''s.png'");
}

TEST(TrackCommandLine, NamesAllInputsOrTheFolderThatHoldsNoOthers) {
    const testing::ScratchFolder folder;
    std::vector<std::filesystem::path> frames;
    for (const char* name : {"1.png", "2.png", "3.png", "10.png"}) {
        frames.emplace_back(folder / name);
        testing::write_png(frames.back().string(), Image(4, 4, 0));
    }
    const std::string whole = frames[0].parent_path().string();
    EXPECT_EQ(track_command_line({}, frames), "grainfield track '" + whole + "' -o tracks.h5");
    testing::write_png(folder / "11.png", Image(4, 4, 0));
    EXPECT_EQ(track_command_line({}, frames), "grainfield track '" + frames[0].string() + "' '" +
                                                  frames[1].string() + "' '" + frames[2].string() +
                                                  "' '" + frames[3].string() + "' -o tracks.h5");
}

TEST(TuneCommand, SaysTheInputsAsTheyWereTyped) {
    const testing::ScratchFolder folder;
    std::filesystem::create_directory(folder / "frames");
    for (int f = 0; f < 5; ++f) {
        testing::write_png(folder / ("frames/" + std::to_string(f) + ".png"),
                           testing::disc_frame(testing::few_discs(), f));
    }
    const std::string pattern = folder / "frames/*.png";
    TuneCommand command;
    const std::vector<OptionTable> tables = command.options();
    tables.front().set("output", OptionValue(folder / "tune.html"));
    tables.front().set("figures", OptionValue(false));
    Session session;
    session.command = "tune";
    session.inputs = {pattern};
    const Summary summary = command.run(session);
    EXPECT_TRUE(summary.facts["command_line"].get<std::string>().starts_with(
        "grainfield track '" + pattern + "' -o tracks.h5 "));
}

}  // namespace
}  // namespace grainfield::app
