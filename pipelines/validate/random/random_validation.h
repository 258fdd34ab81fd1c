#pragma once

#include <vector>

#include "pipelines/job.h"
#include "pipelines/validate/random/random_scores.h"
#include "pipelines/validate/validate_job.h"

namespace grainfield::pipelines {

/// What was found over cameras drawn at random.
struct RandomValidationResult {
    std::vector<SceneScore> scenes;  ///< in the order of their numbers
    std::vector<ThresholdCheck> checks;
    int signal = 0;  ///< that ended it early; 0: none
};

/// Whether a validation is one over cameras drawn at random (optics `random`).
bool is_random(const ValidateJobOptions& options);

/// Says in the plan what run_random_validation would do. Throws OptionError.
void plan_random_validation(const ValidateJobOptions& options, Job& job);

/// Draws, simulates, renders, tracks and scores the scenes side by side, each on one thread, and
/// writes the page: medians and worst, a table of the scenes, and the worst scenes with what was
/// missed and what is false. Scores depend on the seed alone, not on the number of threads; times
/// do. Stopped by a signal it gives the scenes that are done. Throws OptionError if frames or a
/// trajectory are given, OutputError, PhysicsError, Interrupted before the first scene is done.
RandomValidationResult run_random_validation(const ValidateJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
