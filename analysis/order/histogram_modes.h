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
    std::optional<double> low_mode_error;
    std::optional<double> high_mode_error;
    std::optional<double> minimum_error;
    std::string reason;  ///< why there are not two modes
};

/// Finds the two highest peaks of a histogram over [0, 1] and the minimum between them.
///
/// The counts c_j at the centres x_j are smoothed by a Gaussian g of standard deviation `smoothing`
/// [unit of the axis] with reflection at both ends, y(x) = Σ_j c_j g(x − x_j). Positions are the
/// zeros of y'. Their standard errors follow from those of the counts,
///
///   error² = Σ_j (c_j/share) g'(x − x_j)² / y''(x)²,
///
/// where `share` ≤ 1 is the number of independent particles over the number counted; the smoothing
/// itself moves a peak by much less than its width. An error that exceeds half the distance to the
/// other features is left out: the curve is too flat there. So is that of a peak at 0 or 1.
///
/// A dip counts if it lies below the lower peak by more than 6 standard errors of counting (a flat
/// histogram of 50 bins shows one with a probability below 1e-6) and by more than a tenth of it.
HistogramModes find_modes(std::span<const double> counts, double share = 1,
                          double smoothing = 0.03);

}  // namespace grainfield::analysis
