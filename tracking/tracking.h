#pragma once

#include "core/frame_source.h"
#include "core/run_plan.h"
#include "core/support/progress.h"
#include "core/trajectory.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {

/// How the spheres of one image are found. Everything is estimated unless it is given.
struct LocateOptions {
    CalibrationOptions calibration = {};
    DetectionOptions detection = {};
    RefinementOptions refinement = {};
    VisiblePixels visible = {};  ///< pixels that are looked at
    int threads = 0;             ///< 0: all
};

/// Finds every sphere of one image: positions, standard errors [px] and RMS residuals, for the
/// model of discs with a blurred edge that is calibrated on the same image (calibrate, Locator).
///
/// The image is in counts of any scale that spans two or more. Without spheres the snapshot is
/// empty; `plan` then holds the warning why, and else what was estimated and what was skipped.
/// Positions do not depend on the number of threads. Throws InputError if the image is empty,
/// OptionError for options out of range.
Snapshot locate(const Image& image, const LocateOptions& options = {}, RunPlan* plan = nullptr);

/// What may be watched while a film is tracked.
struct TrackObservers {
    RunPlan* plan = nullptr;       ///< told what was decided, and warnings
    Progress* progress = nullptr;  ///< advanced by one a frame
};

/// Finds every sphere of every frame and follows it through time (Tracker). The trajectory is kept
/// in memory. Throws what the source and Tracker throw.
Trajectory track(FrameSource& frames, const TrackOptions& options = {},
                 const TrackObservers& observers = {});

/// The same into a sink, snapshot by snapshot: memory does not grow with the film.
TrackSummary track(FrameSource& frames, SnapshotSink& sink, const TrackOptions& options = {},
                   const TrackObservers& observers = {});

}  // namespace grainfield::tracking
