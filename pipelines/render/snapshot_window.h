#pragma once

#include <cstdint>
#include <vector>

#include "core/trajectory.h"
#include "simulate/render/motion/grain_motion.h"

namespace grainfield::pipelines {

/// A snapshot with those around it that its exposure needs. Keeps a few, so that reading in order
/// reads each of them once.
class SnapshotWindow {
 public:
    /// `source` must outlive this.
    explicit SnapshotWindow(SnapshotSource& source) : source_(source) {}

    /// Snapshot `index`, those nearer in time than `reach` [time unit], and one more on either
    /// side; no others if `reach` is 0. Valid until the next call.
    simulate::SnapshotSeries around(std::int64_t index, double reach);

 private:
    const Snapshot& at(std::int64_t index);

    SnapshotSource& source_;
    std::int64_t first_ = 0;  ///< number of kept_[0]
    std::vector<Snapshot> kept_;
};

}  // namespace grainfield::pipelines
