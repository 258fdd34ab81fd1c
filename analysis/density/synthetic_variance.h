#pragma once

#include <vector>

#include "analysis/spectra/spectrum_model.h"

namespace grainfield::analysis {

/// Number variance of a square window with its standard error, from the covariance of S(k).
struct SyntheticVariance {
    double variance = 0;
    double error = 0;
    double beyond = 0;  ///< the part of it from k > k_max, where S = tail is assumed
};

/// σ²(ℓ) of square windows of side ℓ in a periodic box of side L that always holds the same number
/// of particles, from S(k):
///
///   σ²(ℓ) = n ℓ² (1 − ℓ²/L²) + (n ℓ⁴/L²) Σ_{k≠0} (S(k) − 1) w(k_x ℓ/2)² w(k_y ℓ/2)²,
///
/// k = 2π (n_x, n_y)/L, w(x) = sin(x)/x, n the number density [1/a²], ℓ ≤ L [a]. S is
/// constant beyond k_max, so that the sum is finite and nothing is cut off; at ℓ = L σ² = 0.
/// (`torquato2003` for the infinite system; the sum and its stable form: docs/analysis/density.md.)
/// Cost O((L k_max/2π)²) for each ℓ. Throws OptionError if L k_max/2π is above 4000.
std::vector<SyntheticVariance> synthetic_variance(const SpectrumModel& model, double density,
                                                  double side, const std::vector<double>& windows);

/// The same for L → ∞,
///
///   σ²(ℓ) = (n ℓ²/2π) ∫_0^∞ q A(q) S(q/ℓ) dq,
///
/// A the average of w(q_x/2)² w(q_y/2)² over directions (∫ q A dq = 2π): all terms are positive, so
/// that nothing cancels where S(0) = 0. Gauss–Legendre between the corners of S(k); above q = 64π A
/// is taken as 8/q³, its mean over a period, which is right to 1/q².
std::vector<SyntheticVariance> synthetic_variance(const SpectrumModel& model, double density,
                                                  const std::vector<double>& windows);

/// A(q), to about 1e-12. Cost O(q) sines.
double window_power(double q);

}  // namespace grainfield::analysis
