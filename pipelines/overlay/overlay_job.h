#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "pipelines/job.h"

namespace grainfield::pipelines {

/// What an overlay is asked for; the trajectory is the first input of the job.
struct OverlayJobOptions {
    std::filesystem::path output;  ///< video to write
    std::filesystem::path film;    ///< video or folder that was tracked; empty: as recorded
    std::int64_t trail = 25;       ///< [frames] that a trail reaches back
    std::optional<double> fps;     ///< of the video [1/s]; empty: as filmed, 25 above 60
};

/// What was drawn.
struct OverlayJobResult {
    std::int64_t frames = 0;
    int width = 0, height = 0;  ///< [px]
    double fps = 0;             ///< [1/s]
    bool has_film = false;      ///< else on white
    int signal = 0;             ///< that ended it early; 0: none
};

/// Says in the plan what draw_overlay would do. Throws InputError.
void plan_overlay(const OverlayJobOptions& options, Job& job);

/// Draws every snapshot of a trajectory over its frame (report::Overlay) into a video. The film is
/// the one named, or those inputs of the recorded run that are still there. Without a film the
/// particles are drawn on white, and a warning says so where there should be one. Stopped by a
/// signal, the frames drawn so far are a complete video. Throws InputError, OptionError,
/// OutputError.
OverlayJobResult draw_overlay(const OverlayJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
