#pragma once

#include <filesystem>

#include "analysis/fit_result.h"
#include "analysis/structure_factor.h"
#include "app/command.h"
#include "core/results.h"

namespace grainfield::app {

/// Results of a field file: what the run accumulated on its way, or, if asked for or if there is
/// none of it, what the same estimators find in the stored fields. The record is left empty.
Results field_results(const std::filesystem::path& path, bool from_fields,
                      const analysis::StructureFactorOptions& options,
                      const analysis::FitOptions& fit, Session& session);

}  // namespace grainfield::app
