#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "pipelines/validate/validation_outcome.h"
#include "pipelines/validate/validation_thresholds.h"
#include "tracking/tracker.h"

namespace grainfield::app {

/// The scores for scripts (docs/validation.md); what could not be measured is null.
nlohmann::ordered_json summary_facts(const pipelines::ValidationOutcome& outcome,
                                     const tracking::TrackSummary& tracked,
                                     const std::vector<pipelines::ThresholdCheck>& checks);
/// The scores for people; `output` names the report.
std::string summary_text(const std::string& output, const pipelines::ValidationOutcome& outcome,
                         const std::vector<pipelines::ThresholdCheck>& checks);
/// The checks that were missed, in one line; empty if there are none.
std::string missed_thresholds(const std::vector<pipelines::ThresholdCheck>& checks);

}  // namespace grainfield::app
