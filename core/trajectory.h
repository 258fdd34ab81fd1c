#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/run_identity.h"
#include "core/snapshot.h"
#include "core/unit.h"

namespace grainfield {

/// What is known about the particle diameter of a trajectory.
enum class DiameterOrigin : std::uint8_t {
    stated,     ///< as the file or the table of points says
    simulated,  ///< the true a of a simulation or of rendered frames
    given,      ///< the true a, given by the user
    apparent    ///< the diameter D of the discs in the images stands for it: a was not given
};

/// What all snapshots of a trajectory share.
struct TrajectoryInfo {
    Origin origin = Origin::points;
    LengthUnit length_unit = LengthUnit::diameter;
    TimeUnit time_unit = TimeUnit::frame;
    double diameter = 1;  ///< a, or the apparent D that stands for it [length unit]
    DiameterOrigin diameter_origin = DiameterOrigin::stated;
    std::optional<ControlValue> control{};      ///< what the run was driven with, if it is known
    std::optional<double> vibration_frequency;  ///< [1/time unit]
    std::optional<double> frame_rate;           ///< frames per time unit
    std::string source;                         ///< names of the inputs, for people
};

inline RunIdentity identity_of(const TrajectoryInfo& info) {
    return {.origin = info.origin, .control = info.control};
}

/// Positions per frame with identity and time: the one form that a lab video, an MD run and a
/// rendered validation all take. Snapshots are in order of time; a missing frame is simply absent
/// (its index is skipped).
struct Trajectory {
    TrajectoryInfo info;
    std::vector<Snapshot> snapshots;
};

/// Delivers snapshots one at a time, so that memory does not grow with the number of frames.
class SnapshotSource {
 public:
    virtual ~SnapshotSource() = default;
    virtual const TrajectoryInfo& info() const = 0;
    virtual std::int64_t count() const = 0;

    /// Snapshot number `index` in [0, count()), in order of time.
    virtual Snapshot read(std::int64_t index) = 0;
};

/// Receives snapshots one at a time, in order of time.
class SnapshotSink {
 public:
    virtual ~SnapshotSink() = default;
    virtual void write(const Snapshot& snapshot) = 0;
};

}  // namespace grainfield
