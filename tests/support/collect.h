#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/trajectory.h"

namespace grainfield::testing {

/// The frames as every `step`-th of a longer film, a second apart.
inline std::vector<Frame> numbered(std::vector<Frame> frames, std::int64_t step = 1) {
    for (std::size_t i = 0; i < frames.size(); ++i) {
        frames[i].index = static_cast<std::int64_t>(i) * step;
        frames[i].time = static_cast<double>(i);
    }
    return frames;
}

/// Keeps every snapshot.
class Collect : public SnapshotSink {
 public:
    void write(const Snapshot& snapshot) override {
        require_consistent(snapshot);
        snapshots.push_back(snapshot);
    }
    std::vector<Snapshot> snapshots;
};

}  // namespace grainfield::testing
