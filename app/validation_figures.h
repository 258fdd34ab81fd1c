#pragma once

#include <vector>

#include "app/validation_outcome.h"
#include "report/figure.h"

namespace grainfield::app {

/// The plots of a validation: pixel locking, pulls, what is missed and the error under overlap, the
/// offset of the MSD, and S(k) of the tracked over that of the true positions.
std::vector<report::Figure> validation_figures(const ValidationOutcome& outcome);

}  // namespace grainfield::app
