#pragma once

#include <optional>
#include <vector>

#include "core/results.h"

namespace grainfield::pipelines {

/// By blocks of how many pixels a side frames were fitted, as the file of a trajectory holds it:
/// one row. Why is not there: it differs between a film and its kept calibration.
Curve binning_curve(int side);

/// The same from the curves of a trajectory; empty if they do not say, as those of versions up to
/// 2026-11-26, or if what is there is none.
std::optional<int> stored_binning(const std::vector<Curve>& curves);

}  // namespace grainfield::pipelines
