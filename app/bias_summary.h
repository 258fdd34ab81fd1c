#pragma once

#include <nlohmann/json.hpp>

#include "tracking/bias_decision.h"

namespace grainfield::app {

/// What was decided of the bias of positions, for --json.
nlohmann::ordered_json bias_facts(const tracking::BiasDecision& decision);

}  // namespace grainfield::app
