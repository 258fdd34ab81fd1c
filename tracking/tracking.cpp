#include "tracking/tracking.h"

#include "core/memory_frames.h"

namespace grainfield::tracking {
namespace {

/// Keeps every snapshot.
class Keep : public SnapshotSink {
 public:
    explicit Keep(std::vector<Snapshot>& snapshots) : snapshots_(snapshots) {}
    void write(const Snapshot& snapshot) override { snapshots_.push_back(snapshot); }

 private:
    std::vector<Snapshot>& snapshots_;
};

TrackSummary run(Tracker& tracker, FrameSource& frames, SnapshotSink& sink,
                 const TrackObservers& observers) {
    Progress quiet("tracking", frames.count(), "frames", Verbosity::quiet);
    return tracker.run(sink, observers.progress != nullptr ? *observers.progress : quiet);
}

}  // namespace

Snapshot locate(const Image& image, const LocateOptions& options, RunPlan* plan) {
    MemoryFrames frames({image}, {}, "image");
    TrackOptions all;
    all.calibration = options.calibration;
    all.detection = options.detection;
    all.refinement = options.refinement;
    all.visible = options.visible;
    all.threads = options.threads;
    return track(frames, all, {.plan = plan}).snapshots.at(0);
}

Trajectory track(FrameSource& frames, const TrackOptions& options,
                 const TrackObservers& observers) {
    RunPlan unseen;
    Tracker tracker(frames, options, observers.plan != nullptr ? *observers.plan : unseen);
    Trajectory trajectory{tracker.info(), {}};
    Keep sink(trajectory.snapshots);
    run(tracker, frames, sink, observers);
    return trajectory;
}

TrackSummary track(FrameSource& frames, SnapshotSink& sink, const TrackOptions& options,
                   const TrackObservers& observers) {
    RunPlan unseen;
    Tracker tracker(frames, options, observers.plan != nullptr ? *observers.plan : unseen);
    return run(tracker, frames, sink, observers);
}

}  // namespace grainfield::tracking
