#pragma once

#include <vector>

#include "pipelines/validate/validation_outcome.h"
#include "report/figures/figure.h"

namespace grainfield::pipelines {

/// The plots of a validation: pixel locking, pulls, what is missed and the error under overlap, the
/// offset of the MSD, and S(k) of the tracked over that of the true positions.
std::vector<report::Figure> validation_figures(const ValidationOutcome& outcome);

}  // namespace grainfield::pipelines
