#pragma once

#include <cstdint>
#include <vector>

#include "app/validation_scores.h"
#include "core/results.h"

namespace grainfield::app {

/// One observable quantity, from the true and from the tracked positions.
struct DownstreamEffect {
    std::string name;   ///< "solid_fraction"
    std::string title;  ///< "Solid fraction"
    std::string unit;
    double truth = 0;
    double tracked = 0;
    double error = 0;  ///< standard error of the tracked one, NaN if unknown
};

/// All that a validation found out.
struct ValidationOutcome {
    ValidationScores scores;
    tracking::TrackScores tracks;
    std::vector<Results> runs;  ///< true, tracked; without observables if interrupted
    std::vector<DownstreamEffect> effects;
    double msd_offset = 0;  ///< MSD tracked − true at the shortest lag [a²]; NaN: unknown
    double predicted_msd_offset = 0;  ///< 4σ², σ the RMSE per axis of class all [a²]
};

/// Compares what the analysis says of both runs: every measurement that both have; then S(k) for
/// ka < 0.3 and the RMS deviation of the whole curve, and the offset of the MSD.
void compare_downstream(ValidationOutcome& outcome);

}  // namespace grainfield::app
