#pragma once

#include <filesystem>

#include "analysis/field_analysis.h"
#include "app/command.h"
#include "core/results.h"

namespace grainfield::app {

/// Results of a field file: what the run accumulated on its way, or, if asked for or if there is
/// none of it, what the same estimators find in the stored fields; fits of S(k) are made anew. The
/// record is left empty.
Results field_results(const std::filesystem::path& path, bool from_fields,
                      const analysis::FieldAnalysisOptions& options, Session& session);

}  // namespace grainfield::app
