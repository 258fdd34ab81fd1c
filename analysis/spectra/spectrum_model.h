#pragma once

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <vector>

#include "analysis/statistics/spectrum_fit.h"

namespace grainfield::analysis {

/// S(k) at every k, made of what was measured: a sum of parameters θ times fixed functions φ(k),
///
///   S(k) = S0 + S1 (ka)^α           k ≤ k_fit, if there is a fit
///        = line through the shells  k_fit < k ≤ k_max
///        = tail                     k > k_max: 1 of particles, the last known value of a field
///
/// so that whatever is linear in S has an error by the covariance of θ: (S0, S1) correlated as the
/// likelihood says, shells independent of each other and of the fit.
class SpectrumModel {
 public:
    /// Part of a parameter in S at some k.
    struct Share {
        std::size_t parameter = 0;
        double weight = 0;
    };

    struct Line {  // of a fit S0 + S1 (ka)^α, with standard errors (NaN: not known)
        double s0 = 0, s1 = 0, alpha = 1;
        double s0_error = 0, s1_error = 0;
        double correlation = 0;
        double k_end = 0;  ///< end of its range [1/a]
    };

    /// What S(k) is taken for where nothing is measured.
    enum class Tail {
        one,       ///< particles without correlation
        constant,  ///< a field: the last value, as its noise sets the scale
    };

    /// S0 + S1 (ka)^α up to where it reaches one, then one; of a field up to the end of its range,
    /// then constant: no pre-peak, nothing measured beyond.
    static SpectrumModel of_fit(const Line& fit, Tail tail = Tail::one);

    /// The fit below its end, the shells above; without a fit the first shell's value below it.
    /// `spectrum.error` may hold NaN or be short: then S/sqrt(ν). Shells without a finite S, or
    /// whose modes are too slow for the run (ν = 0), are left out.
    static SpectrumModel of_measured(const Spectrum& spectrum, const std::optional<Line>& fit,
                                     Tail tail = Tail::one);

    /// Two shares; a weight of zero where only one parameter, or none, counts.
    std::array<Share, 2> shares(double k) const;
    double value(double k) const;

    double k_max() const { return k_max_; }
    double tail() const { return tail_; }
    /// Lowest wavevector of which something is known: 0 with a fit.
    double k_min() const { return fit_ ? 0 : (k_.empty() ? k_max_ : k_.front()); }
    std::size_t size() const { return theta_.size(); }
    const std::vector<double>& theta() const { return theta_; }

    /// Where S(k) has corners: 0, k_fit, the shells, k_max; rising.
    const std::vector<double>& corners() const { return corners_; }

    /// Variance of Σ_p J_p θ_p; NaN where a parameter that counts (J_p ≠ 0) has no error.
    double variance(const std::vector<double>& jacobian) const;

    /// Whether small k are those of a fit; otherwise nothing is known below the lowest shell.
    bool has_fit() const { return fit_.has_value(); }

 private:
    std::optional<Line> fit_;  // parameters 0 and 1
    std::vector<double> k_;    // of the shells, whose parameters follow
    std::vector<double> theta_, error_;
    std::vector<double> corners_;
    double k_max_ = 0;
    double tail_ = 1;
};

}  // namespace grainfield::analysis
