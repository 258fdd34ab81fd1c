#include "pipelines/lab.h"

#include <algorithm>
#include <initializer_list>
#include <string>

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

/// What a file of options leaves where these stand on the command line.
LabUnits left_of(LabUnits lab, std::initializer_list<std::string> given) {
    make_room_for(lab, [&](const std::string& name) {
        return std::ranges::find(given, name) != given.end();
    });
    return lab;
}

const LabUnits file_of_gamma{.sphere_mm = 1, .gamma = 4, .frequency = {}, .amplitude_mm = {}};
const LabUnits file_of_motion{.sphere_mm = 1, .gamma = {}, .frequency = 80, .amplitude_mm = 0.1};

TEST(LabUnitsOfAFile, KeepsGammaUnlessBothFrequencyAndAmplitudeAreKnown) {
    EXPECT_EQ(left_of(file_of_gamma, {}).gamma, 4);
    EXPECT_EQ(left_of(file_of_gamma, {"vibration-frequency"}).gamma, 4);
    EXPECT_FALSE(left_of(file_of_gamma, {"vibration-frequency", "amplitude-mm"}).gamma);
    LabUnits file = file_of_gamma;
    file.frequency = 80;
    EXPECT_FALSE(left_of(file, {"amplitude-mm"}).gamma);
    EXPECT_EQ(left_of(file, {"amplitude-mm"}).frequency, 80);
}

TEST(LabUnitsOfAFile, GiveWayToGammaAndKeepTheFrequency) {
    const LabUnits left = left_of(file_of_motion, {"gamma"});
    EXPECT_EQ(left.frequency, 80);
    EXPECT_FALSE(left.amplitude_mm);
    EXPECT_EQ(left.sphere_mm, 1);
    const LabUnits other = left_of(file_of_motion, {"gamma", "amplitude-mm"});
    EXPECT_FALSE(other.frequency);
}

}  // namespace
}  // namespace grainfield::pipelines
