#pragma once

#include <filesystem>
#include <optional>

#include "core/trajectory.h"
#include "io/h5/trajectory_file.h"

namespace grainfield::pipelines {

/// Snapshots of a long run, kept in whole files between checkpoints: OUTPUT.segment-0, -1, …
///
/// A checkpoint vouches for the segments before it; whatever came later is written again by the
/// resumed run, so that the merged trajectory is the one of a run that was never interrupted.
class SnapshotSegments : public SnapshotSink {
 public:
    SnapshotSegments(std::filesystem::path output, TrajectoryInfo info, std::int64_t existing);

    void write(const Snapshot& snapshot) override;
    /// Completes the present segment; nothing where no snapshot came.
    void close();
    std::int64_t count() const { return count_; }

    /// All snapshots in order. A frame that two segments have is taken from the later one. Throws
    /// Interrupted once a signal was caught; the segments stay.
    void merge_into(SnapshotSink& sink);
    /// Removes all segments of this output.
    void remove();

 private:
    std::filesystem::path path(std::int64_t segment) const;

    std::filesystem::path output_;
    TrajectoryInfo info_;
    std::int64_t count_;
    std::optional<io::TrajectoryWriter> writer_;
};

}  // namespace grainfield::pipelines
