#pragma once

#include <array>
#include <span>
#include <string>

#include "analysis/statistics/critical.h"

namespace grainfield::analysis {

enum class PowerConstant {
    none,  ///< ratio = factor x^power: it vanishes at zero
    free   ///< ratio = constant + factor x^power
};

/// S0/S1 [-] as a power of the control parameter x: the factor has the unit of x^−power.
struct CriticalPower {
    double constant = 0;
    double factor = 0;
    double power = 0;
    double constant_error = 0;  ///< 0 for PowerConstant::none
    double factor_error = 0;
    double power_error = 0;
    double chi2 = 0;
    int points = 0;
    std::string reason;  ///< why there is no fit; then all numbers are zero

    bool ok() const { return reason.empty(); }
    double value(double x) const;        ///< x >= 0
    double value_error(double x) const;  ///< of the fit at x, first order

    double reference = 1;  ///< geometric mean of all x
    /// Of constant, factor·reference^power, power; the first row is zero for PowerConstant::none.
    std::array<std::array<double, 3>, 3> covariance{};
};

/// Weighted least squares of constant + factor x^power; the power is searched in [0.02, 8].
///
/// At a given power the rest is linear, so that one number is searched: a scan, then golden
/// section. Errors from the linearised model with the errors as they are given; chi2 says whether
/// it describes the points. As many points as there are parameters are needed, all with x > 0.
/// Cost O(points). Thread-safe.
CriticalPower fit_critical_power(std::span<const CriticalPoint> points, PowerConstant constant);

}  // namespace grainfield::analysis
