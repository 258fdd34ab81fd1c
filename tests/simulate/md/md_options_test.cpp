#include "simulate/md/md_options.h"

#include <cmath>

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
