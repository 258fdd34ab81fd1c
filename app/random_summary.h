#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "pipelines/validate/random/random_validation.h"

namespace grainfield::app {

/// Medians, worst and each scene for scripts (docs/validation.md); what could not be measured is
/// null.
nlohmann::ordered_json random_facts(const pipelines::RandomValidationResult& result);
/// Medians and worst for people, and the worst scene; `output` names the report.
std::string random_text(const std::string& output, const pipelines::RandomValidationResult& result);

}  // namespace grainfield::app
