#pragma once

#include <optional>
#include <span>
#include <string>

#include "analysis/statistics/critical.h"
#include "core/quantity_titles.h"
#include "core/results.h"

namespace grainfield::analysis {

/// The observable "critical": measurements critical_value, critical_low, critical_high, slope,
/// intercept (of a power: power, factor, constant), chi2_per_dof; curves "critical" (x, s0_over_s1,
/// err) and "critical_line" (x, s0_over_s1, err). Where the shared exponent was fitted, `alpha`
/// says it. A critical value outside the points says so in its reason.
ObservableResult critical_result(std::span<const CriticalPoint> points, CriticalLine line,
                                 const std::string& parameter,
                                 const std::optional<Measurement>& alpha);

/// What its measurements are called.
ObservableTitles critical_titles();

}  // namespace grainfield::analysis
