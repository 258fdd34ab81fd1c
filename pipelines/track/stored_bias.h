#pragma once

#include <optional>
#include <vector>

#include "core/results.h"
#include "tracking/bias_decision.h"

namespace grainfield::pipelines {

/// What was decided of the bias of positions, as the file of a trajectory holds it: one row.
Curve curve_of(const tracking::BiasDecision& decision);

/// The decision, from the curves of a trajectory; empty if they do not say, as those of versions up
/// to 2026-11-26 or of positions by synthesis, or if what is there is none.
std::optional<tracking::BiasDecision> stored_bias(const std::vector<Curve>& curves);

}  // namespace grainfield::pipelines
