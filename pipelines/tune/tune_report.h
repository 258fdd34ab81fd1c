#pragma once

#include <string>
#include <utility>
#include <vector>

#include "pipelines/job.h"
#include "report/report.h"
#include "tracking/survey.h"

namespace grainfield::pipelines {

/// What `tune` saw.
struct Tuning {
    const tracking::ImageModel& model;
    const tracking::TrackOptions& options;
    const std::vector<tracking::Survey>& surveys;

    double particles_mean() const;
    double residual_rms() const;
    /// Unit of the analysis: the sphere, or its disc [px].
    double diameter() const;
    /// No two spheres are closer in projection [px]; 0 without a height of the cell.
    double forbidden_distance() const;
};

/// Settings that fix what was estimated and save what the film does not need: "section.name" and
/// its value as TOML has it.
std::vector<std::pair<std::string, std::string>> suggested_settings(const Tuning& tuning,
                                                                    const Job& job);

/// They as a configuration file, and as words of a command line.
std::string toml_of(const std::vector<std::pair<std::string, std::string>>& settings);
std::string command_line_of(const std::vector<std::pair<std::string, std::string>>& settings,
                            const Job& job);

/// Tables and figures of the page.
report::ReportAdditions tuning_report(
    const Tuning& tuning, const std::vector<std::pair<std::string, std::string>>& settings,
    const std::string& command_line);

}  // namespace grainfield::pipelines
