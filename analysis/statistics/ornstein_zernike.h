#pragma once

#include <string>

#include "analysis/statistics/spectrum_fit.h"

namespace grainfield::analysis {

/// S(k) = S(0)/(1 + (ξk)²).
struct OrnsteinZernikeFit {
    double s_zero = 0;        ///< S(0) [-]
    double xi = 0;            ///< correlation length ξ [a]
    double s_zero_error = 0;  ///< standard errors, times sqrt(χ²/dof) where that exceeds one
    double xi_error = 0;
    double chi2_per_dof = 0;
    double k_max = 0;  ///< [1/a] the largest k that took part
    int points = 0;
    std::string reason;  ///< why there is no fit; then all numbers are zero

    bool ok() const { return reason.empty(); }
    double value(double k) const;
};

/// Fits the Ornstein–Zernike form to the shells with k ≤ k_max by maximum likelihood: each S_i is
/// the mean of ν_i exponentially distributed numbers of mean μ_i (`whittle1953`), and with
/// 1/μ = p + q k² = (1 + (ξk)²)/S(0)
///
///   ln L = Σ_i ν_i (ln(p + q k_i²) − S_i (p + q k_i²))
///
/// is concave in (p, q): Newton's method with halving finds the one maximum. Errors from its second
/// derivatives. There is no fit where S does not fall with k (q ≤ 0), where it has no finite limit
/// (p ≤ 0), or with fewer than three shells. Cost O(shells) a step. Thread-safe.
OrnsteinZernikeFit fit_ornstein_zernike(const Spectrum& spectrum, double k_max);

}  // namespace grainfield::analysis
