#include "pipelines/overlay/particle_values.h"

#include <atomic>
#include <cmath>
#include <csignal>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/stored_trajectory.h"
#include "core/support/interrupt.h"

namespace grainfield::pipelines {
namespace {

/// A square lattice of spacing 1.1 a, a = 10 px; sphere k moves by k/4 px a frame in x, at 50
/// frames a second.
Trajectory drift(int frames) {
    Trajectory trajectory;
    trajectory.info.origin = Origin::video;
    trajectory.info.length_unit = LengthUnit::pixel;
    trajectory.info.time_unit = TimeUnit::second;
    trajectory.info.frame_rate = 50;
    trajectory.info.diameter = 10;
    for (int f = 0; f < frames; ++f) {
        Snapshot snapshot;
        snapshot.frame = f;
        snapshot.time = f / 50.0;
        snapshot.box.length = {200, 200};
        for (int k = 0; k < 25; ++k) {
            snapshot.position.push_back(
                {20.0 + 11 * (k % 5) + 0.25 * k * f, 20.0 + 11.0 * (k / 5)});
            snapshot.id.push_back(k);
        }
        trajectory.snapshots.push_back(snapshot);
    }
    return trajectory;
}

TEST(ParticleValues, SpeedsAreStepsOverTimeInDiameters) {
    StoredTrajectory source(drift(4));
    ParticleValues values(OverlayColour::speed, source);
    EXPECT_EQ(values.key().title, "speed (a/s)");
    // The fastest moves by 6 px in 0.02 s: 30 a/s. The range ends at the next 1, 2 or 5.
    EXPECT_DOUBLE_EQ(values.key().high, 50);
    for (std::int64_t f = 0; f < source.count(); ++f) {
        const std::vector<double> speed = values.next(source.read(f));
        ASSERT_EQ(speed.size(), 25U);
        for (std::size_t k = 0; k < speed.size(); ++k) {
            EXPECT_NEAR(speed[k], 0.25 * static_cast<double>(k) * 50 / 10, 1e-9) << "frame " << f;
        }
    }
}

TEST(ParticleValues, AParticleThatWasNotThereBeforeHasNoSpeed) {
    Trajectory trajectory = drift(3);
    trajectory.snapshots[2].id[7] = 99;
    StoredTrajectory source(trajectory);
    ParticleValues values(OverlayColour::speed, source);
    for (std::int64_t f = 0; f < 2; ++f) values.next(source.read(f));
    const std::vector<double> speed = values.next(source.read(2));
    EXPECT_TRUE(std::isnan(speed[7]));
    EXPECT_FALSE(std::isnan(speed[8]));
}

TEST(ParticleValues, PhasesAreThoseOfTheTimeAverage) {
    Trajectory trajectory = drift(10);
    for (Snapshot& snapshot : trajectory.snapshots)
        snapshot.position = trajectory.snapshots[0].position;
    StoredTrajectory source(trajectory);
    ParticleValues values(OverlayColour::phase, source);
    const std::vector<double> phase = values.next(source.read(3));
    EXPECT_EQ(phase[12], 2) << "the middle of a square lattice is solid";
    EXPECT_EQ(values.key().classes.size(), 3U);
}

TEST(ParticleValues, ASignalEndsTheLookAtAllFrames) {
    StoredTrajectory source(drift(10));
    const std::atomic<int> stop{SIGINT};
    const StoppableJob stopped(stop);
    EXPECT_THROW(ParticleValues(OverlayColour::phase, source), Interrupted);
    EXPECT_THROW(ParticleValues(OverlayColour::speed, source), Interrupted);
    EXPECT_NO_THROW(ParticleValues(OverlayColour::order, source)) << "one frame is enough";
}

TEST(ParticleValues, WhatTheTrajectoryDoesNotHoldIsRefused) {
    Trajectory trajectory = drift(2);
    StoredTrajectory layers(trajectory);
    EXPECT_THROW(ParticleValues(OverlayColour::layer, layers), InputError);
    for (Snapshot& snapshot : trajectory.snapshots) {
        snapshot.id.clear();
        snapshot.layer.assign(25, Layer::top);
    }
    trajectory.snapshots[1].layer[3] = Layer::unknown;
    StoredTrajectory unlinked(trajectory);
    EXPECT_THROW(ParticleValues(OverlayColour::speed, unlinked), InputError);
    ParticleValues values(OverlayColour::layer, unlinked);
    values.next(unlinked.read(0));
    const std::vector<double> layer = values.next(unlinked.read(1));
    EXPECT_EQ(layer[2], 1);
    EXPECT_TRUE(std::isnan(layer[3]));
}

}  // namespace
}  // namespace grainfield::pipelines
