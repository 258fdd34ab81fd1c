#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pipelines/job.h"
#include "pipelines/render/optics_use.h"
#include "pipelines/validate/random/random_options.h"
#include "pipelines/validate/validation.h"
#include "pipelines/validate/validation_scene.h"
#include "pipelines/validate/validation_thresholds.h"
#include "report/report.h"

namespace grainfield::pipelines {

/// What a validation is asked for. Frames that are inputs of the job need `scene.truth`; without
/// inputs they are rendered.
struct ValidateJobOptions {
    std::filesystem::path output;  ///< HTML page
    SceneOptions scene;
    int previews = 1;  ///< frames shown on the page
    report::ReportOptions report;
    tracking::TrackOptions tracking;
    std::string calibration;  ///< file of a kept calibration to use; empty: calibrate
    analysis::FitOptions fit;
    ValidationThresholds thresholds;
    RandomThresholds random_thresholds;  ///< of cameras drawn at random
};

/// What was found.
struct ValidateJobResult {
    ValidationOutcome outcome;
    tracking::TrackSummary tracked;
    std::vector<ThresholdCheck> checks;
    std::optional<OpticsUse> optics;  ///< of rendered frames
    int signal = 0;                   ///< that ended it early; 0: none
};

/// Says in the plan what run_validation would do. Throws as that does.
void plan_validation(const ValidateJobOptions& options, Job& job);

/// For one camera or given frames; cameras drawn at random: run_random_validation.
///
/// Makes or opens the frames, tracks them, scores what was found against the truth and writes the
/// page. Throws OptionError, InputError, OutputError, PhysicsError, Interrupted.
ValidateJobResult run_validation(const ValidateJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
