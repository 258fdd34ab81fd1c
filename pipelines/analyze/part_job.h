#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/results.h"
#include "pipelines/analyze/analyze_job.h"
#include "pipelines/job.h"

namespace grainfield::pipelines {

/// What one part of an analysis did.
struct PartJobResult {
    std::vector<std::string> observables;  ///< that were measured
    std::int64_t first = 0;                ///< position of the part in its film
    std::int64_t whole = 0;                ///< frames of the film
    std::int64_t frames = 0;               ///< of the part
};

/// Measures what can be merged (analysis::measure_part) of one part of a film, the first input of
/// the job, and writes what the accumulators gathered. Throws as run_analysis does, and InputError
/// if the input is no part.
PartJobResult analyze_part(const AnalyzeJobOptions& options, Job& job);

/// The results of the film from those files of all of its parts, the inputs of the job, in any
/// order. Options of the analysis must be those that the parts were measured with. Throws
/// InputError, naming the file, if parts differ, or frames are missing or there twice; as
/// run_analysis else.
Results merge_parts(const AnalyzeJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
