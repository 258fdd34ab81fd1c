#pragma once

#include <string>
#include <vector>

#include "core/results.h"
#include "report/figures/figure.h"

namespace grainfield::report {

/// S(k)/S1 against k with the fits, (S0 + S1 (ka)^α)/S1, S1 of the fit of each run (`castillo2019`,
/// Fig. 2a, d, g): what is left at small k is S0/S1. The spectrum is the one that was fitted: of
/// the modes between walls where there are any. Runs without a fit, or with S1 ≤ 0, are listed with
/// the reason.
Figure scaled_spectrum(const std::vector<Results>& runs, const std::vector<std::string>& labels);

}  // namespace grainfield::report
