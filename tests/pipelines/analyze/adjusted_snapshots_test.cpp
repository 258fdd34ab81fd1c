#include "pipelines/analyze/adjusted_snapshots.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::pipelines {
namespace {

/// Frame 10 with one particle, frame 12 with three.
class TwoSnapshots : public SnapshotSource {
 public:
    const TrajectoryInfo& info() const override { return info_; }
    std::int64_t count() const override { return 2; }
    Snapshot read(std::int64_t index) override {
        ++reads;
        Snapshot s;
        s.frame = 10 + 2 * index;
        s.time = 77;
        s.box = {{-0.5, -0.5}, {20, 10}, {Boundary::walls, Boundary::walls}, 0};
        s.position.resize(index == 0 ? 1 : 3, place);
        return s;
    }
    int reads = 0;
    Vec2 place;

 private:
    TrajectoryInfo info_;
};

TEST(AdjustedSnapshots, AreAsInTheFileWhenNothingIsAdjusted) {
    TwoSnapshots file;
    AdjustedSnapshots snapshots(file, {});
    EXPECT_EQ(snapshots.read(1).time, 77);
    EXPECT_EQ(snapshots.read(1).box, file.read(1).box);
    EXPECT_EQ(snapshots.info().diameter, 1);
    EXPECT_EQ(snapshots.info().time_unit, TimeUnit::frame);
}

TEST(AdjustedSnapshots, AFrameRateTurnsFrameNumbersIntoSeconds) {
    TwoSnapshots file;
    Adjustment adjustment;
    adjustment.frame_rate = 4;
    AdjustedSnapshots snapshots(file, adjustment);
    EXPECT_EQ(snapshots.read(1).time, 3);
    EXPECT_EQ(snapshots.info().time_unit, TimeUnit::second);
    EXPECT_EQ(snapshots.info().frame_rate, 4);
}

TEST(AdjustedSnapshots, BoxBoundaryAndDiameterReplaceThoseOfTheFile) {
    TwoSnapshots file;
    Adjustment adjustment;
    adjustment.box_length = Vec2{7, 8};
    adjustment.boundary = Boundary::periodic;
    adjustment.particle_diameter = 9;
    adjustment.acceleration = 4.5;
    AdjustedSnapshots snapshots(file, adjustment);
    EXPECT_EQ(snapshots.read(0).box.length, (Vec2{7, 8}));
    EXPECT_TRUE(snapshots.read(0).box.is_periodic());
    EXPECT_EQ(snapshots.info().diameter, 9);
    EXPECT_EQ(snapshots.info().diameter_origin, DiameterOrigin::given);
    EXPECT_EQ(legend_of(identity_of(snapshots.info())), "points, Γ = 4.5");
}

TEST(AdjustedSnapshots, SayPointsBesideTheBoxAndTimesThatStandStill) {
    TwoSnapshots file;
    AdjustedSnapshots as_they_are(file, {});
    as_they_are.particles_mean();
    ASSERT_EQ(as_they_are.warnings().size(), 1U) << "both at time 77";
    EXPECT_THAT(as_they_are.warnings()[0], ::testing::HasSubstr("snapshot 1 is at 77"));
    file.place = {12, 3};
    Adjustment adjustment;
    adjustment.box_length = Vec2{7, 8};
    adjustment.frame_rate = 1;
    AdjustedSnapshots snapshots(file, adjustment);
    EXPECT_TRUE(snapshots.warnings().empty()) << "nothing read yet";
    snapshots.read(1);
    snapshots.read(1);
    ASSERT_EQ(snapshots.warnings().size(), 1U);
    EXPECT_THAT(
        snapshots.warnings()[0],
        ::testing::HasSubstr("3 of 3 points lie outside the box [-0.5, 6.5] × [-0.5, 7.5]"));
    adjustment.boundary = Boundary::periodic;
    AdjustedSnapshots folded(file, adjustment);
    folded.read(1);
    EXPECT_TRUE(folded.warnings().empty());
}

TEST(AdjustedSnapshots, KnowTheLengthOfAFilmByItsTimeStamps) {
    TwoSnapshots file;
    EXPECT_FALSE(AdjustedSnapshots(file, {}).times()) << "times that stand still";
    Adjustment adjustment;
    adjustment.frame_rate = 4;
    AdjustedSnapshots snapshots(file, adjustment);
    ASSERT_TRUE(snapshots.times());
    EXPECT_DOUBLE_EQ(snapshots.times()->interval, 0.5) << "frames 10 and 12";
    EXPECT_DOUBLE_EQ(snapshots.times()->length, 1);
}

TEST(AdjustedSnapshots, MeanNumberOfParticlesReadsOnlyWhatWasNotRead) {
    TwoSnapshots file;
    AdjustedSnapshots snapshots(file, {});
    snapshots.read(1);
    EXPECT_EQ(snapshots.particles_mean(), 2);
    EXPECT_EQ(file.reads, 2);
}

}  // namespace
}  // namespace grainfield::pipelines
