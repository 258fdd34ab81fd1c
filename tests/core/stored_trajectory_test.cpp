#include "core/stored_trajectory.h"

#include <stdexcept>

#include <gtest/gtest.h>

namespace grainfield {
namespace {

TEST(StoredTrajectory, ReadsBackWhatWasWrittenAsOftenAsAsked) {
    StoredTrajectory stored;
    TrajectoryInfo info;
    info.diameter = 8;
    stored.set_info(info);
    for (int f = 0; f < 3; ++f) {
        Snapshot snapshot;
        snapshot.frame = 2 * f;
        snapshot.position = {{1.0 * f, 2}};
        stored.write(snapshot);
    }
    ASSERT_EQ(stored.count(), 3);
    EXPECT_EQ(stored.info().diameter, 8);
    for (int again = 0; again < 2; ++again) {
        EXPECT_EQ(stored.read(2).frame, 4);
        EXPECT_EQ(stored.read(2).position[0].x, 2);
    }
    EXPECT_THROW(stored.at(3), std::out_of_range);
}

TEST(StoredTrajectory, TakesATrajectoryThatExists) {
    Trajectory trajectory;
    trajectory.info.time_unit = TimeUnit::second;
    trajectory.snapshots.resize(2);
    const StoredTrajectory stored(trajectory);
    EXPECT_EQ(stored.count(), 2);
    EXPECT_EQ(stored.info().time_unit, TimeUnit::second);
}

}  // namespace
}  // namespace grainfield
