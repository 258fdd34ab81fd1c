#include "pipelines/analyze/lengths.h"

#include <gtest/gtest.h>

#include "io/h5/trajectory_file.h"
#include "pipelines/track/stored_bias.h"
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

TEST(Lengths, SayWhetherPositionsWereCorrectedForMirrorImages) {
    const testing::ScratchFolder folder;
    const TrajectoryInfo info = info_of(Origin::video);
    const auto said = [&](const tracking::BiasDecision& decision) {
        io::TrajectoryWriter writer(folder / "t.h5", info, Overwrite::force);
        writer.add_curve(curve_of(decision));
        writer.finish({});
        const io::TrajectoryFile file(folder / "t.h5");
        const ObservableResult lengths = lengths_of(file, info, {});
        const Measurement* found = lengths.find_measurement("bias_correction");
        EXPECT_NE(found, nullptr);
        return found == nullptr ? Measurement{} : *found;
    };
    const Measurement general = said({.source = tracking::BiasSource::general,
                                      .cameras = 320,
                                      .moved = 0.0108,
                                      .before = 0.0169,
                                      .after = 0.0083,
                                      .reason = {}});
    EXPECT_EQ(general.value, 0.0108);
    EXPECT_NE(general.reason.find("320 other cameras"), std::string::npos);
    const Measurement none = said({.moved = {}, .reason = "bright spheres mirror no panel"});
    EXPECT_FALSE(none.value.has_value());
    EXPECT_NE(none.reason.find("bright spheres"), std::string::npos);
    EXPECT_EQ(lengths_of(info, {}).find_measurement("bias_correction"), nullptr);
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
