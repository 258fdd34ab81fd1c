#pragma once

#include <optional>
#include <span>
#include <string>

#include "analysis/statistics/spectrum_fit.h"

namespace grainfield::analysis {

/// S0/S1 of one run at a value of the control parameter (Γ, ε, ν …).
struct CriticalPoint {
    double x = 0;      ///< control parameter [-]
    double ratio = 0;  ///< S0/S1 [-]
    double error = 0;  ///< standard error, > 0
};

enum class CriticalLine {
    free,               ///< ratio = slope (x − x_c), x_c fitted
    through_zero,       ///< ratio = slope x: the parameter is the distance to the critical point
    power,              ///< ratio = factor x^power: it vanishes at zero, and the power is fitted
    power_and_constant  ///< ratio = constant + factor x^power: is its limit at zero above zero?
};

struct CriticalFit {
    double slope = 0;
    double slope_error = 0;
    double intercept = 0;  ///< of the ratio at x = 0
    double intercept_error = 0;
    double covariance = 0;  ///< of slope and intercept
    double chi2 = 0;
    int points = 0;
    std::optional<double> critical;    ///< x_c = −intercept/slope
    std::optional<Interval> interval;  ///< 68 %; empty where the slope may vanish
    std::string reason;                ///< why there is no fit, or no critical value or interval

    double value(double x) const { return intercept + slope * x; }
    double value_error(double x) const;
};

/// Weighted straight line through S0/S1 and where it reaches zero.
///
/// The interval of x_c holds the x at which the line is zero within its standard error,
/// (a + b x)² ≤ σ_a² + 2 x σ_ab + x² σ_b² (`fieller1954`): asymmetric where it must be, and none
/// where the slope differs from zero by less than its error. Errors are taken as they are given;
/// chi2 says whether the line describes the points. At least three points (two through zero). The
/// two powers are no lines: they are refused with a reason (fit_critical_power).
CriticalFit fit_critical(std::span<const CriticalPoint> points, CriticalLine line);

}  // namespace grainfield::analysis
