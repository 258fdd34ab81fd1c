#pragma once

#include <memory>
#include <optional>
#include <string>
#include <unordered_set>
#include <vector>

#include "core/trajectory.h"

namespace grainfield::pipelines {

/// What the user says about a trajectory, against or beyond what its file says.
struct Adjustment {
    std::optional<Vec2> box_length;           ///< [length unit of the file]
    std::optional<Boundary> boundary;         ///< of both axes
    std::optional<double> frame_rate;         ///< [1/s]: times become frame / rate
    std::optional<double> particle_diameter;  ///< the true a [length unit of the file]
    std::optional<double> acceleration;       ///< Γ = Aω²/g of the vibration

    void apply_to(TrajectoryInfo& info) const;
    void apply_to(Snapshot& snapshot) const;

    bool operator==(const Adjustment&) const = default;
};

/// How long a trajectory is by its time stamps [time unit].
struct FilmTimes {
    double interval = 0;  ///< median from snapshot to snapshot
    double length = 0;    ///< from the first to the last, and one interval
};

/// Snapshots of another source as the adjustment says they are; counts particles as they pass and
/// stops with Interrupted at the next snapshot once a signal was caught.
class AdjustedSnapshots : public SnapshotSource {
 public:
    AdjustedSnapshots(SnapshotSource& source, const Adjustment& adjustment);

    const TrajectoryInfo& info() const override { return info_; }
    std::int64_t count() const override { return source_.count(); }
    Snapshot read(std::int64_t index) override;

    /// Makes a snapshot from elsewhere as the adjustment says.
    void adjust(Snapshot& snapshot) const { adjustment_.apply_to(snapshot); }

    /// Whether a snapshot with that frame number was read.
    bool has_read(std::int64_t frame) const { return frames_.contains(frame); }
    /// Mean over the snapshots; reads those that were not read yet.
    double particles_mean();
    /// By all time stamps; reads those that were not read yet. Empty: fewer than two snapshots, or
    /// times that do not grow.
    std::optional<FilmTimes> times();
    /// What is strange in those read so far: points beside the box, times that do not grow.
    std::vector<std::string> warnings() const;

 private:
    SnapshotSource& source_;
    Adjustment adjustment_;
    TrajectoryInfo info_;
    void look_at(const Snapshot& snapshot, std::int64_t index);

    std::vector<std::int64_t> particles_;      ///< per snapshot, -1: not read yet
    std::int64_t outside_ = 0;                 ///< particles beside a walled box
    Box box_;                                  ///< that the first of them is beside
    std::vector<double> time_;                 ///< per snapshot, NaN: not read yet
    std::unordered_set<std::int64_t> frames_;  ///< of those read
};

}  // namespace grainfield::pipelines
