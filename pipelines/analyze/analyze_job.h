#pragma once

#include <filesystem>
#include <string>

#include "analysis/analysis.h"
#include "core/results.h"
#include "io/frame_range.h"
#include "pipelines/analyze/adjusted_snapshots.h"
#include "pipelines/field/field_results.h"
#include "pipelines/job.h"

namespace grainfield::pipelines {

/// What an analysis is asked for; its input is the first of the job: a trajectory, a table of
/// points or a field file.
struct AnalyzeJobOptions {
    std::filesystem::path output;
    std::string label;                    ///< name in plots; empty: made from what the input says
    std::string frames = io::kAllFrames;  ///< which of those in the file (io/frame_range.h)
    Adjustment adjustment;                ///< of trajectories and points
    std::filesystem::path wavevectors;    ///< table of wavevectors for S(k); empty: none
    FieldSamples fields = FieldSamples::accumulated;
    analysis::AnalysisOptions analysis;
};

/// Says in the plan what run_analysis would measure and what not. Throws as that does.
void plan_analysis(const AnalyzeJobOptions& options, Job& job);

/// Measures the observables, writes them to the output and returns them. Throws OptionError,
/// InputError, OutputError; Interrupted, and no output, after a signal.
Results run_analysis(const AnalyzeJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
