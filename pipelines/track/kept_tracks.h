#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "core/results.h"
#include "core/support/output_file.h"
#include "core/trajectory.h"
#include "io/h5/snapshot_log.h"
#include "io/h5/trajectory_file.h"
#include "pipelines/job.h"
#include "pipelines/resumable.h"

namespace grainfield::pipelines {

/// The trajectory file being written, shared with the thread that closes it if a signal finds the
/// work stuck in one frame. Counts what is written: tracks that are too short are not.
class KeptTracks : public SnapshotSink {
 public:
    /// `origin`: where the frames begin in those of the source [px]. Snapshots and previews are
    /// given in pixels of the frames and written in pixels of the source. `log` gets every snapshot
    /// as it comes; null: none.
    KeptTracks(OutputFile output, const TrajectoryInfo& info, Vec2 origin, io::SnapshotLog* log);

    void write(const Snapshot& snapshot) override;
    /// Writes again what the log of an interrupted run holds.
    void replay();

    /// `found`: what the tracker found in it; replaced by what is written of that, if it comes
    /// later.
    void add_preview(const Frame& frame, const Snapshot& found);
    void add_curve(const Curve& curve);
    void finish(const RunRecord& record);

    std::int64_t frames() const;
    double particles_mean() const;

 private:
    void keep(const Snapshot& snapshot);

    mutable std::mutex mutex_;
    io::TrajectoryWriter writer_;
    Vec2 origin_;
    io::SnapshotLog* log_;
    std::vector<Preview> previews_;
    std::int64_t frames_ = 0;
    std::int64_t last_frame_ = -1;
    double particles_ = 0;
};

/// What a signal leaves if the work does not stop by itself: the frames that are written, as a
/// complete file, and the last checkpoint if there is one.
class LastAct {
 public:
    /// `resumable` must outlive this.
    LastAct(Job job, const Resumable& resumable);

    /// From now on there is something to keep; `job` as it is now is recorded with it.
    void holds(KeptTracks* tracks, const Job& job);
    /// Returns what is to be said, "warning: …" or "error: …".
    std::string operator()();

 private:
    std::mutex mutex_;
    Job job_;
    const Resumable& resumable_;
    KeptTracks* tracks_ = nullptr;
};

}  // namespace grainfield::pipelines
