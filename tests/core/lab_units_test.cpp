#include "core/lab_units.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(LabUnits, GiveTheAccelerationOfAVibration) {
    // By hand: (2π 80)² 0.1e-3 / 9.80665.
    EXPECT_NEAR(acceleration_of(80, 0.1), 252661.8725 * 1e-4 / 9.80665, 1e-6);
    LabUnits lab{.sphere_mm = {}, .gamma = {}, .frequency = 80, .amplitude_mm = 0.1};
    EXPECT_NEAR(*lab.acceleration(), 2.57643, 1e-4);
    lab.amplitude_mm.reset();
    EXPECT_FALSE(lab.acceleration()) << "a frequency alone says nothing of it";
    lab.gamma = 4.5;
    EXPECT_EQ(lab.acceleration(), 4.5);
}

TEST(LabUnits, GiveTheTimeUnitOfASimulation) {
    EXPECT_NEAR(seconds_of_time_unit(9.80665), std::sqrt(1e-3), 1e-15);
}

TEST(LabUnits, ThatContradictEachOtherAreRefusedWithBothValues) {
    LabUnits lab{.sphere_mm = {}, .gamma = 2.58, .frequency = 80, .amplitude_mm = 0.1};
    EXPECT_EQ(lab.acceleration(), 2.58) << "0.14 % apart: rounded";
    lab.gamma = 2.62;
    EXPECT_THAT([&] { lab.acceleration(); },
                ThrowsMessage<OptionError>(
                    AllOf(HasSubstr("2.62"), HasSubstr("2.57643"), HasSubstr("80 Hz"))));
}

}  // namespace
}  // namespace grainfield
