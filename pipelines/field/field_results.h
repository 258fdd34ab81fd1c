#pragma once

#include <filesystem>
#include <string>

#include "analysis/density/field_analysis.h"
#include "core/results.h"
#include "io/frame_range.h"
#include "pipelines/job.h"

namespace grainfield::pipelines {

/// Which samples of a field file are analysed.
enum class FieldSamples {
    accumulated,  ///< all that the run accumulated; the stored ones if there are none
    stored,       ///< the stored fields
};

/// Which part of a field file is analysed.
struct FieldChoice {
    FieldSamples samples = FieldSamples::accumulated;
    std::string frames = io::kAllFrames;  ///< which of the stored fields (io/frame_range.h)
};

/// Says in the plan which samples field_results would take. Throws as that does.
void plan_field_results(const std::filesystem::path& path, const FieldChoice& choice,
                        RunPlan& plan);

/// Results of a field file, by the estimators that the run accumulates with; fits of S(k) are made
/// anew. The record is left empty. Throws InputError, and OptionError if some frames are asked for
/// of what was accumulated over all.
Results field_results(const std::filesystem::path& path, const FieldChoice& choice,
                      const analysis::FieldAnalysisOptions& options, Job& job);

}  // namespace grainfield::pipelines
