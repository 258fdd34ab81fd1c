#pragma once

#include <filesystem>

#include "analysis/density/field_analysis.h"
#include "core/results.h"
#include "pipelines/job.h"

namespace grainfield::pipelines {

/// Which samples of a field file are analysed.
enum class FieldSamples {
    accumulated,  ///< all that the run accumulated; the stored ones if there are none
    stored,       ///< the stored fields
};

/// Says in the plan which samples field_results would take.
void plan_field_results(const std::filesystem::path& path, FieldSamples samples, RunPlan& plan);

/// Results of a field file, by the estimators that the run accumulates with; fits of S(k) are made
/// anew. The record is left empty. Throws InputError.
Results field_results(const std::filesystem::path& path, FieldSamples samples,
                      const analysis::FieldAnalysisOptions& options, Job& job);

}  // namespace grainfield::pipelines
