#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/snapshot.h"

namespace grainfield {

enum class LengthUnit { pixel, diameter };             ///< video: pixel; simulation: a
enum class TimeUnit { frame, second, sqrt_a_over_g };  ///< `frame` when no frame rate is known
enum class Origin { video, md, rendered, points };     ///< where the particles come from

/// What all snapshots of a trajectory share.
struct TrajectoryInfo {
    Origin origin = Origin::points;
    LengthUnit length_unit = LengthUnit::diameter;
    TimeUnit time_unit = TimeUnit::frame;
    double diameter = 1;  ///< particle diameter a [length unit]; video: calibrated or apparent D
    std::optional<double> vibration_frequency;  ///< [1/time unit]
    std::optional<double> frame_rate;           ///< frames per time unit
    std::string source;                         ///< names of the inputs, for people
};

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
