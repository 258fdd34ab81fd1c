#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace grainfield::analysis {

/// What a histogram of |Q4| looks like after smoothing.
struct HistogramModes {
    std::optional<double> low_mode;   ///< position of the lower of the two highest peaks
    std::optional<double> high_mode;  ///< position of the upper one
    std::optional<double> minimum;    ///< position of the lowest point between them
    std::optional<double> minimum_error;
    std::string reason;  ///< why there are not two modes
};

/// Finds the two highest peaks of a histogram over [0, 1] and the minimum between them.
///
/// The counts are smoothed by a Gaussian of standard deviation `smoothing` [unit of the axis] with
/// reflection at both ends; a dip counts if it lies below the lower peak by more than 6 standard
/// errors of counting (a flat histogram of 50 bins shows one with a probability below 1e-6) and by
/// more than a tenth of it. The error of the minimum is the half-width
/// of the region that counting noise cannot tell from it (at least half a bin).
HistogramModes find_modes(std::span<const double> counts, double smoothing = 0.03);

}  // namespace grainfield::analysis
