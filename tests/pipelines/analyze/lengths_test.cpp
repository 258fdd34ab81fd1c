#include "pipelines/analyze/lengths.h"

#include <gtest/gtest.h>

#include "io/h5/trajectory_file.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::pipelines {
namespace {

TrajectoryInfo info_of(Origin origin) {
    TrajectoryInfo info;
    info.origin = origin;
    info.length_unit = origin == Origin::video ? LengthUnit::pixel : LengthUnit::diameter;
    info.diameter = origin == Origin::video ? 12 : 1;
    return info;
}

/// The description of a trajectory and the record of its run, through a file.
io::TrajectoryFile through_file(const testing::ScratchFolder& folder, const TrajectoryInfo& info,
                                const RunRecord& record) {
    io::TrajectoryWriter writer(folder / "t.h5", info, Overwrite::force);
    writer.add_curve(calibration_curve(9, 1.5, 0.13, 0.12));
    writer.finish(record);
    return io::TrajectoryFile(folder / "t.h5");
}

// The names of options are those of no version: whoever needs them finds nothing.
RunRecord renamed_record(const std::string& command) {
    RunRecord record;
    record.command = command;
    record.configuration = {{"drive.stroke", "0.09"}, {"drive.speed", "5"}, {"bead.size", "12"}};
    return record;
}

TEST(Lengths, SayWhatIsKnownOfTheDiameterWhateverTheOptionsAreCalled) {
    const testing::ScratchFolder folder;
    TrajectoryInfo info = info_of(Origin::video);
    const auto reason = [&](DiameterOrigin origin, const Adjustment& adjustment = {}) {
        info.diameter_origin = origin;
        const io::TrajectoryFile file = through_file(folder, info, renamed_record("track"));
        TrajectoryInfo adjusted = file.info();
        adjustment.apply_to(adjusted);
        return lengths_of(file, adjusted, adjustment).measurements.at(0).reason;
    };
    EXPECT_EQ(reason(DiameterOrigin::given), "given to track");
    EXPECT_EQ(reason(DiameterOrigin::apparent),
              "not given: the apparent diameter of the discs stands for it");
    EXPECT_EQ(reason(DiameterOrigin::stated), "as the file says");
    EXPECT_EQ(reason(DiameterOrigin::simulated), "as the file says");
    Adjustment adjustment;
    adjustment.particle_diameter = 14;
    EXPECT_EQ(reason(DiameterOrigin::apparent, adjustment), "given to analyze");
}

TEST(Lengths, HoldTheCalibrationBesideTheParticleDiameter) {
    const testing::ScratchFolder folder;
    const TrajectoryInfo info = info_of(Origin::video);
    const io::TrajectoryFile file = through_file(folder, info, {});
    const ObservableResult lengths = lengths_of(file, info, {});
    ASSERT_EQ(lengths.measurements.size(), 5U);
    EXPECT_EQ(lengths.measurements[0].unit, Unit("px"));
    EXPECT_EQ(lengths.find_measurement("apparent_diameter")->value, 9);
    EXPECT_EQ(lengths.find_measurement("residual")->value, 0.13);
    EXPECT_EQ(lengths.find_measurement("noise")->value, 0.12);
    EXPECT_EQ(lengths.find_measurement("noise")->reason, "measured by track");
}

TEST(RunIdentity, OfMolecularDynamicsArrivesWhateverTheOptionsAreCalled) {
    const testing::ScratchFolder folder;
    TrajectoryInfo info = info_of(Origin::md);
    info.control = ControlValue{.parameter = ControlParameter::acceleration, .value = 2.25};
    const io::TrajectoryFile file = through_file(folder, info, renamed_record("simulate md"));
    TrajectoryInfo adjusted = file.info();
    Adjustment{}.apply_to(adjusted);
    EXPECT_EQ(legend_of(identity_of(adjusted)), "MD, Γ = 2.25");
}

TEST(RunIdentity, ThatIsNotKnownIsNotGuessedFromTheRecordOfANewFile) {
    const testing::ScratchFolder folder;
    RunRecord record = renamed_record("simulate md");
    record.configuration = {{"vibration.amplitude", "0.09"}, {"vibration.angular-frequency", "5"}};
    EXPECT_EQ(through_file(folder, info_of(Origin::md), record).info().control, std::nullopt);
}

}  // namespace
}  // namespace grainfield::pipelines
