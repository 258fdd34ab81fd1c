#pragma once

#include <cstdint>

#include "core/frame.h"
#include "core/run_plan.h"
#include "tracking/layers/bilayer.h"
#include "tracking/link/linker.h"
#include "tracking/locate.h"
#include "tracking/repeated_warnings.h"
#include "tracking/synthesis/film_synthesis.h"

namespace grainfield::tracking {

/// Where the time of a run went, per frame.
struct FrameTimes {
    double read = 0, detect = 0, refine = 0, synthesis = 0, link = 0, write = 0;  ///< [ms]
    double wall = 0;  ///< by the clock [ms]; less than the sum where frames are fitted side by side
};

/// What it took to fit a frame, without the search for cores: mean over those that were fitted.
struct FrameWork {
    double frames = 0;        ///< that were fitted
    double discs = 0;         ///< of the model
    double disc_updates = 0;  ///< Newton steps of one disc, on blocks of a coarse search too
    double joint_steps = 0;   ///< of all discs at once
    double gain_maps = 0;     ///< of the search; a second look makes its own
    double trials = 0;        ///< discs added on trial …
    double trials_kept = 0;   ///< … that stayed
};

struct TrackSummary {
    std::int64_t frames = 0;  ///< tracked
    std::int64_t frames_corrupt = 0, frames_missing = 0;
    double particles_mean = 0;
    double residual_rms = 0;     ///< of image − model, mean over frames [contrast]
    double noise = 0;            ///< of the camera, mean over frames [contrast]
    double step_rms = 0;         ///< RMS displacement between consecutive frames [px]; 0: one frame
    std::int64_t unsettled = 0;  ///< spheres still moving after the last sweep, all frames
    std::int64_t rejected = 0;   ///< of those, left out: they moved by more than their error
    /// Frames in which all spheres that explain little were taken for false, as most had no room.
    std::int64_t strict_frames = 0;
    std::int64_t mended = 0;            ///< rows where one sphere took the place of two, all frames
    std::int64_t warm_frames = 0;       ///< started from the positions of the frame before
    std::int64_t repeated = 0;          ///< frames that repeat the one before: not fitted again
    std::int64_t poor_frames = 0;       ///< that the image model explains badly
    std::int64_t worst_frame = 0;       ///< of those
    double worst_residual = 0;          ///< RMS residual of that frame [contrast]
    double dimmest = 1, brightest = 1;  ///< contrast of the frames relative to the first [-]
    Bilayer::Summary layers;            ///< zeros without a height of the cell
    SynthesisSummary synthesis;         ///< zeros without synthesis
    FrameTimes ms_per_frame;
    FrameWork work_per_frame;
};

/// Adds what a frame showed of the fit. What is wrong with it goes into `repeated`, or once into
/// `plan`.
void judge(const Located& found, const Frame& frame, TrackSummary& summary,
           RepeatedWarnings& repeated, RunPlan& plan);

/// Adds what it took to fit a frame.
void add(const Located& found, FrameWork& work);

/// Makes means of the sums over frames; `particles` are those of all frames.
void average(TrackSummary& summary, double particles, const LinkSummary& links);

/// Warns of what a user should know of the frames as a whole.
void warn_of(const TrackSummary& summary, RunPlan& plan);

}  // namespace grainfield::tracking
