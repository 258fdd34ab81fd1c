#pragma once

#include <utility>
#include <vector>

#include "core/trajectory.h"

namespace grainfield::pipelines {

/// A trajectory in memory: written once, read as often as needed.
class StoredSnapshots : public SnapshotSink, public SnapshotSource {
 public:
    void write(const Snapshot& snapshot) override { trajectory_.snapshots.push_back(snapshot); }
    const TrajectoryInfo& info() const override { return trajectory_.info; }
    void set_info(TrajectoryInfo info) { trajectory_.info = std::move(info); }
    std::int64_t count() const override {
        return static_cast<std::int64_t>(trajectory_.snapshots.size());
    }
    Snapshot read(std::int64_t index) override { return at(index); }
    const Snapshot& at(std::int64_t index) const {
        return trajectory_.snapshots.at(static_cast<std::size_t>(index));
    }
    const Trajectory& trajectory() const { return trajectory_; }

 private:
    Trajectory trajectory_;
};

}  // namespace grainfield::pipelines
