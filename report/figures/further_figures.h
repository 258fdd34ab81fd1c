#pragma once

#include <string>
#include <vector>

#include "core/results.h"
#include "report/figures/figure.h"

namespace grainfield::report {

/// The figures beside the main one of an observable: correlation of the order in space and time,
/// fluctuation of the order, |Q4| of single particles, sizes of solid clusters, van Hove function,
/// number variance of other boxes, local exponent of the number variance, anisotropy of S(k). Only
/// those that a run has the curve of.
std::vector<Figure> further_figures(const std::vector<Results>& runs,
                                    const std::vector<std::string>& labels);

}  // namespace grainfield::report
