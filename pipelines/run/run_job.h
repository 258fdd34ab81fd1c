#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/results.h"
#include "pipelines/analyze/analyze_job.h"
#include "pipelines/job.h"
#include "pipelines/track/track_job.h"
#include "report/report.h"

namespace grainfield::pipelines {

/// What a run from film to report is asked for; the film is the inputs of the job. Outputs of the
/// stages are set by the run.
struct RunJobOptions {
    std::filesystem::path folder;  ///< of all outputs; made if it is not there
    TrackJobOptions track;
    AnalyzeJobOptions analyze;
    report::ReportOptions report;
    bool resume = false;  ///< go on with interrupted tracks even where others may be replaced
    bool overlay = true;  ///< also a video of the film with what was found, of two frames or more
};

/// Where a run writes what.
struct RunFiles {
    std::filesystem::path tracks, results, report, overlay;

    explicit RunFiles(const std::filesystem::path& folder);
};

/// One stage and its file.
struct RunStage {
    std::string name;  ///< "track"
    std::filesystem::path file;
    bool is_kept = false;  ///< as an earlier run left it
};

struct RunJobResult {
    std::vector<RunStage> stages;
    std::optional<Results> results;  ///< empty if a signal came before
    LabUnits lab;  ///< as the tracks have it, without Γ (TrajectoryInfo::control)
    std::optional<tracking::BiasDecision> bias;  ///< as the tracks have it
    int signal = 0;                              ///< that ended the run early; 0: none
};

/// The folder for this film where none is named: "layer-results" for layer.avi and for pictures
/// layer_0000.tif, layer_0001.tif …, in the present folder; "cam1-results" for the folder cam1.
std::filesystem::path default_folder(const std::vector<std::filesystem::path>& given);

/// Says in the plan what run_film would do. Throws as that does.
void plan_run(const RunJobOptions& options, Job& job);

/// Tracks a film, analyses the tracks, and writes the report and the overlay: what `track`,
/// `analyze`, `compare` and `export --overlay` do one after the other.
///
/// Called again with the same film and options it goes on where it was stopped. A stage whose file
/// records the same program version, options and content of its inputs is kept; from the first one
/// that differs on all are made again. Tracks of another film, other options or other units of the
/// lab are only replaced with Overwrite::force. Throws OptionError, InputError, OutputError,
/// Interrupted.
RunJobResult run_film(const RunJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
