#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace grainfield::analysis {

/// A measured spectrum as the fit takes it, shells in the order of growing k.
struct Spectrum {
    std::vector<double> k;      ///< [1/a] > 0
    std::vector<double> s;      ///< S(k) [-]
    std::vector<double> dof;    ///< ν: exponentially distributed numbers that S is worth
    std::vector<double> error;  ///< standard error of S; for least squares only
};

enum class FitMethod {
    whittle,       ///< gamma likelihood with the degrees of freedom ν
    least_squares  ///< weights 1/error² as measured: biased low, for comparison
};

/// S(k) = S0 + S1 (k a)^α over k ≤ k_max.
struct SpectrumFit {
    double s0 = 0;
    double s1 = 0;
    double alpha = 0;
    std::array<double, 3> error{};  ///< of s0, s1, alpha; 0 for an alpha that was fixed
    double covariance = 0;          ///< of s0 and s1
    double log_likelihood = 0;      ///< up to a constant
    double k_max = 0;               ///< [1/a]
    double chi2 = 0;                ///< Σ ν (S/fit − 1)², about `points` − parameters
    int points = 0;
    std::string reason;  ///< why there is no fit; then all numbers are zero

    bool ok() const { return reason.empty(); }
    double ratio() const { return s0 / s1; }
    double ratio_error() const;  ///< of s0/s1, first order
    double value(double k) const;
    double value_error(double k) const;  ///< at fixed alpha
};

/// Fits S0 + S1 (ka)^α to the shells with 0 < k ≤ k_max by maximum likelihood: each S_i is the mean
/// of ν_i exponentially distributed numbers of mean μ_i (`whittle1953`),
///
///   ln L = −Σ_i ν_i (ln μ_i + S_i/μ_i),  μ_i = S0 + S1 k_i^α > 0.
///
/// S0 may be negative. With α fixed μ is linear and Fisher scoring (weights ν/μ² of the fit, never
/// of the data, which would bias S0 low) converges in some ten steps with halving; a free α is
/// searched in [0.2, 4]. Errors from the expected information. At least one point more than there
/// are parameters is needed. Cost O(points) a step. Thread-safe.
SpectrumFit fit_spectrum(const Spectrum& spectrum, double k_max, std::optional<double> alpha,
                         FitMethod method = FitMethod::whittle);

/// Whether S is known to grow with k: S1 above two of its standard errors. Only then is S0/S1 a
/// number: near S1 = 0 it may be anything. Without an error of S1 (NaN) nothing is known.
bool rises(double s1, double error);

/// Why S0/S1 is missing where S does not rise. Says how long a run would show a rise: errors fall
/// as the root of the number of independent snapshots.
std::string no_rise(double s1, double error);

/// The same with one α for several spectra, each with its own S0, S1 and range: the α that makes
/// the product of the likelihoods largest. Spectra that cannot be fitted are left out of the search
/// and keep their reason. Where the search ends at 0.2 or 4 there is no fit of any, with the
/// reason.
std::vector<SpectrumFit> fit_shared(std::span<const Spectrum> spectra,
                                    std::span<const double> k_max);

struct Interval {
    double low = 0;
    double high = 0;
};

/// The values of S0/S1 for which the largest likelihood over S1 lies within half a unit of the
/// best: 68 %, asymmetric where it must be. α stays that of the fit. Empty if the fit failed or the
/// interval is open.
std::optional<Interval> ratio_interval(const Spectrum& spectrum, const SpectrumFit& fit);

struct PrePeak {
    std::optional<double> k;  ///< [1/a]
    std::string reason;       ///< why there is none
};

/// The first maximum of S(k) smoothed by a line fitted locally (Gaussian in ln k of width
/// `smoothing`, weights ν) that rises above its deepest point at smaller k and at larger k by more
/// than four standard errors.
PrePeak find_pre_peak(const Spectrum& spectrum, double smoothing = 0.12);

}  // namespace grainfield::analysis
