#include "simulate/md/md_options.h"

#include <cmath>
#include <map>
#include <optional>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::simulate {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

double gamma_of(const VibrationOptions& vibration, double gravity = 1) {
    const VibrationOptions::Motion motion = vibration.motion(gravity);
    return motion.amplitude * std::pow(motion.angular_frequency, 2) / gravity;
}

TEST(VibrationOptions, WithoutAnyMoveThePlatesAsTheyAlwaysDid) {
    const VibrationOptions::Motion motion = VibrationOptions{}.motion(1);
    EXPECT_EQ(motion.amplitude, 0.08);
    EXPECT_EQ(motion.angular_frequency, 5);
}

TEST(VibrationOptions, GammaSetsTheAmplitudeOrTheFrequencyThatIsNotGiven) {
    VibrationOptions alone;
    alone.lab.gamma = 4.5;
    EXPECT_NEAR(gamma_of(alone), 4.5, 1e-12);
    EXPECT_EQ(alone.motion(1).angular_frequency, 5);
    EXPECT_NEAR(gamma_of(alone, 2.5), 4.5, 1e-12) << "in the gravity of the cell";
    VibrationOptions with_amplitude = alone;
    with_amplitude.amplitude = 0.05;
    EXPECT_EQ(with_amplitude.motion(1).amplitude, 0.05);
    EXPECT_NEAR(gamma_of(with_amplitude), 4.5, 1e-12);
    VibrationOptions with_frequency = alone;
    with_frequency.angular_frequency = 7;
    EXPECT_EQ(with_frequency.motion(1).angular_frequency, 7);
    EXPECT_NEAR(gamma_of(with_frequency), 4.5, 1e-12);
}

// Γ has no unit: that of Hz and mm is that of the run.
TEST(VibrationOptions, HzAndMmAreThoseOfTheSpheres) {
    for (const double mm : {0.5, 1.0, 3.0}) {
        VibrationOptions lab;
        lab.lab = {.sphere_mm = mm, .gamma = {}, .frequency = 80, .amplitude_mm = 0.1};
        EXPECT_NEAR(gamma_of(lab), acceleration_of(80, 0.1), 1e-12);
        EXPECT_NEAR(lab.motion(1).amplitude, 0.1 / mm, 1e-15);
    }
    VibrationOptions gamma;
    gamma.lab = {.sphere_mm = 1, .gamma = 4, .frequency = 80, .amplitude_mm = {}};
    EXPECT_NEAR(gamma_of(gamma), 4, 1e-12);
    // 2π 80 s⁻¹ · sqrt(1e-3 m / 9.80665 m s⁻²) = 5.0759.
    EXPECT_NEAR(gamma.motion(1).angular_frequency, 5.0759, 1e-4);
}

TEST(VibrationOptions, ThatContradictEachOtherAreRefusedWithBothValues) {
    VibrationOptions three;
    three.amplitude = 0.1;
    three.angular_frequency = 5;
    three.lab.gamma = 3;
    EXPECT_THAT(
        [&] { three.motion(1); },
        ThrowsMessage<OptionError>(AllOf(HasSubstr("vibration.gamma: 3"), HasSubstr(": 2.5"))));
    three.lab.gamma = 2.5;
    EXPECT_NEAR(gamma_of(three), 2.5, 1e-12) << "said twice, and the same";
    VibrationOptions two;
    two.amplitude = 0.08;
    two.lab = {.sphere_mm = 2, .gamma = {}, .frequency = {}, .amplitude_mm = 0.2};
    EXPECT_THAT([&] { two.motion(1); },
                ThrowsMessage<OptionError>(AllOf(HasSubstr("vibration.amplitude: 0.08"),
                                                 HasSubstr("vibration.amplitude-mm: 0.1"))));
}

TEST(VibrationOptions, ThatFollowFromOthersKeepTheRangesOfTheirOptions) {
    VibrationOptions mm;
    mm.lab = {.sphere_mm = 0.5, .gamma = {}, .frequency = {}, .amplitude_mm = 600};
    EXPECT_THAT([&] { mm.motion(1); },
                ThrowsMessage<OptionError>(
                    AllOf(HasSubstr("vibration.amplitude-mm 600"), HasSubstr("of 1200"))));
    VibrationOptions hz;
    hz.lab = {.sphere_mm = 1, .gamma = {}, .frequency = 1e6, .amplitude_mm = {}};
    EXPECT_THAT([&] { hz.motion(1); },
                ThrowsMessage<OptionError>(
                    AllOf(HasSubstr("vibration.frequency 1e+06"), HasSubstr("of 63448"))));
    VibrationOptions gamma;
    gamma.lab.gamma = 1e6;
    EXPECT_THAT([&] { gamma.motion(1); },
                ThrowsMessage<OptionError>(
                    AllOf(HasSubstr("vibration.gamma 1e+06"), HasSubstr("of 40000"))));
    gamma.amplitude = 1e-6;
    EXPECT_THAT([&] { gamma.motion(1); },
                ThrowsMessage<OptionError>(
                    AllOf(HasSubstr("vibration.gamma 1e+06"), HasSubstr("of 1e+06"))));
}

using Given = VibrationOptions::Given;

/// As when these are on the command line, and `held` is what a file said.
VibrationOptions with_room(VibrationOptions held, const std::map<std::string, Given>& given) {
    held.make_room_for([&](const std::string& name) {
        const auto found = given.find(name);
        return found == given.end() ? Given::no : found->second;
    });
    return held;
}

TEST(VibrationOptions, MakeRoomForWhatContradictsThem) {
    VibrationOptions both;
    both.amplitude = 0.1;
    both.angular_frequency = 7;
    const VibrationOptions for_gamma = with_room(both, {{"gamma", Given::as_value}});
    EXPECT_EQ(for_gamma.amplitude, std::nullopt);
    EXPECT_EQ(for_gamma.angular_frequency, 7);
    const std::map<std::string, Given> by_frequency{{"gamma", Given::as_value},
                                                    {"angular-frequency", Given::as_auto}};
    EXPECT_EQ(with_room(both, by_frequency).amplitude, 0.1);
    EXPECT_EQ(with_room(both, by_frequency).angular_frequency, std::nullopt);
    const VibrationOptions for_mm = with_room(both, {{"amplitude-mm", Given::as_value}});
    EXPECT_EQ(for_mm.amplitude, std::nullopt);
    EXPECT_EQ(for_mm.angular_frequency, 7);
    EXPECT_EQ(with_room(both, {{"frequency", Given::as_value}}).angular_frequency, std::nullopt);
    EXPECT_EQ(with_room(both, {}).amplitude, 0.1);
}

TEST(VibrationOptions, GammaMakesRoomForAmplitudeAndFrequency) {
    VibrationOptions held;
    held.lab.gamma = 3;
    const VibrationOptions alone = with_room(held, {{"amplitude", Given::as_value}});
    EXPECT_EQ(alone.lab.gamma, 3) << "the frequency follows";
    held.angular_frequency = 7;
    EXPECT_EQ(with_room(held, {{"amplitude", Given::as_value}}).lab.gamma, std::nullopt);
    EXPECT_EQ(with_room(held, {{"frequency", Given::as_value}}).lab.gamma, 3);
}

TEST(VibrationOptions, OfALabNeedTheSphereAndGravity) {
    VibrationOptions lab;
    lab.lab.frequency = 80;
    EXPECT_THAT([&] { lab.motion(1); }, ThrowsMessage<OptionError>(HasSubstr("diameter-mm")));
    VibrationOptions gamma;
    gamma.lab.gamma = 4;
    EXPECT_THAT([&] { gamma.motion(0); }, ThrowsMessage<OptionError>(HasSubstr("gravity")));
    gamma.amplitude = 0;
    EXPECT_THAT([&] { gamma.motion(1); }, ThrowsMessage<OptionError>(HasSubstr("amplitude is 0")));
}

}  // namespace
}  // namespace grainfield::simulate
