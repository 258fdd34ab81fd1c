#pragma once

#include <cstdint>
#include <functional>
#include <optional>

#include "analysis/spectra/fit_result.h"
#include "core/frame_source.h"
#include "core/run_plan.h"
#include "core/support/progress.h"
#include "core/trajectory.h"
#include "pipelines/validate/validation_outcome.h"
#include "tracking/tracker.h"

namespace grainfield::pipelines {

/// Frames and what is true of them.
struct ValidationCase {
    FrameSource& frames;
    SnapshotSource& truth;                  ///< snapshot i belongs to frame i; px, with identities
    std::optional<double> sphere_diameter;  ///< true a [px]; empty: the tracker's apparent D
    std::optional<double> vibration_frequency;  ///< [1/time unit of the truth]
};

struct ValidationSettings {
    tracking::TrackOptions tracking;
    analysis::FitOptions fit;  ///< of S(k), true and tracked; fitted with α free as well
    int previews = 1;          ///< frames kept for the report
    int threads = 1;
    Verbosity verbosity = Verbosity::normal;
    bool slow_frames = false;  ///< a frame takes long: show the progress from the first one on
    std::function<void()> on_frame = {};  ///< called after each frame that was tracked
};

/// Tracks the frames, scores what was found against the truth, and analyses both. True positions
/// less than D/4 inside the frame, where the tracker reports nothing, are left out of the analysis.
/// After an interrupt the frames done so far are scored and the analysis is left out. Throws
/// PhysicsError if the tracker finds nothing to calibrate on.
///
/// Memory: all positions, about 200 B a particle and frame; refused beforehand if there is not so
/// much (OptionError).
ValidationOutcome validate(const ValidationCase& scene, const ValidationSettings& settings,
                           tracking::TrackSummary& summary, RunPlan& plan);

/// Throws OptionError if so many particles, summed over the frames, do not fit into `available`
/// bytes (infinite: unknown).
void require_memory(double particles, double available);

}  // namespace grainfield::pipelines
