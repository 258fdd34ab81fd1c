#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/results.h"
#include "pipelines/validate/validation_scores.h"

namespace grainfield::pipelines {

/// One observable quantity, from the true and from the tracked positions.
struct DownstreamEffect {
    std::string name;   ///< stable key of scripts: "solid_fraction"
    std::string title;  ///< for people: "Solid fraction"
    Unit unit;
    double truth = 0;    ///< NaN: not measured
    double tracked = 0;  ///< NaN: not measured
    double error = 0;    ///< standard error of the tracked one, NaN if unknown
    std::string reason;  ///< why a value or its error is not there
};

/// All that a validation found out.
struct ValidationOutcome {
    ValidationScores scores;
    tracking::TrackScores tracks;
    std::vector<Results> runs;  ///< true, tracked; without observables if interrupted
    /// The fit of S(k) with a free exponent, true and tracked; empty if interrupted.
    std::vector<ObservableResult> free_fits;
    std::vector<DownstreamEffect> effects;
    double msd_offset = 0;  ///< MSD tracked − true at the shortest lag [a²]; NaN: unknown
    double predicted_msd_offset = 0;  ///< 4σ², σ the RMSE per axis of class all [a²]
    bool truth_is_whole = false;      ///< true positions are whole pixels, all of them
};

/// Of whole pixels, per axis: that of a coordinate rounded to them, 1/sqrt(12) [px].
constexpr double kRoundingError = 0.29;

/// Why the Cramér–Rao bound, which knows the noise of the camera alone, says nothing here: a
/// sentence without its full stop where the error of class all is more than three times the bound.
/// Empty where the bound does say something, and where there is none.
std::string bound_caveat(const ValidationOutcome& outcome);

/// Names the observables and measurements that are compared, by the keys of the analysis.
struct ComparedMeasurement {
    const char* observable;   ///< "fit"; "free fit": of free_fits
    const char* measurement;  ///< "s0_over_s1"
    const char* name;         ///< of the effect
    const char* title;
    const char* of_one_frame = nullptr;  ///< its name where there is one frame, if another
};
const std::vector<ComparedMeasurement>& compared_measurements();

/// Compares what the analysis says of both runs: every one of compared_measurements(), with the
/// reason where one is not there; then S(k) for ka < 0.3 and the RMS deviation of the whole curve,
/// and the offset of the MSD.
void compare_downstream(ValidationOutcome& outcome);

}  // namespace grainfield::pipelines
