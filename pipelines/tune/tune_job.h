#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "pipelines/film/film.h"
#include "pipelines/job.h"
#include "pipelines/tune/tune_settings.h"
#include "report/report.h"
#include "tracking/tracker.h"

namespace grainfield::pipelines {

/// What a preview of the tracker is asked for; the film is the inputs of the job.
struct TuneJobOptions {
    std::filesystem::path output;  ///< HTML page; settings and figures go beside it
    std::int64_t samples = 3;      ///< frames looked at, spread over the film
    FilmOptions film;
    tracking::TrackOptions tracking;
    report::ReportOptions report;
    /// How to track with the settings, for the page; empty: not said there.
    std::function<std::string(const std::vector<Setting>&)> in_words;
};

/// What was seen.
struct TuneJobResult {
    std::int64_t frames = 0;
    double particles_mean = 0;
    double residual_rms = 0;  ///< [contrast]
    double diameter = 0;      ///< apparent D [px]
    double edge_width = 0;    ///< w [px]
    std::vector<Setting> settings;
    std::filesystem::path settings_file;
    /// Sizes and polarities that calibration weighed; without settings none was clear enough.
    std::vector<tracking::SizeCandidate> weighed;
    /// What to do where a size that was given explains little; empty: nothing. The settings are
    /// then those of the better one.
    std::string advice{};
};

/// Says in the plan what tracking with these options would do; calibrates for it.
void plan_tuning(const TuneJobOptions& options, Job& job);

/// Looks at some frames as the tracker would, each from a cold start, and writes the page and the
/// suggested settings. The page shows what calibration weighed too, each candidate as a picture
/// with its discs and settings; where none is clear it shows these alone. Throws OptionError,
/// InputError, OutputError, Interrupted.
TuneJobResult run_tuning(const TuneJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
