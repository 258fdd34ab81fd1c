#include "app/tune_command.h"

#include <gtest/gtest.h>

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

TEST(TrackCommandLine, NamesThreeInputsAtMost) {
    const std::string text = track_command_line({}, {"a.png", "b.png", "c.png", "d.png"});
    EXPECT_EQ(text, "grainfield track 'a.png' … -o tracks.h5");
}

}  // namespace
}  // namespace grainfield::app
