#pragma once

#include <filesystem>

#include "analysis/density/field_analysis.h"
#include "core/results.h"
#include "pipelines/session.h"

namespace grainfield::pipelines {

/// Results of a field file: what the run accumulated on its way, or, if asked for or if there is
/// none of it, what the same estimators find in the stored fields; fits of S(k) are made anew. The
/// record is left empty.
Results field_results(const std::filesystem::path& path, bool from_fields,
                      const analysis::FieldAnalysisOptions& options, Session& session);

}  // namespace grainfield::pipelines
