#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "io/frame_files.h"
#include "pipelines/job.h"
#include "pipelines/render/optics_use.h"
#include "pipelines/resumable.h"
#include "simulate/render/render_options.h"

namespace grainfield::pipelines {

/// What rendering is asked for; the trajectory is the first input of the job.
struct RenderJobOptions {
    std::string output;            ///< video, or folder for pictures
    std::string truth;             ///< trajectory file for the true positions [px]; empty: none
    std::int64_t most_frames = 0;  ///< no more than these; 0: all
    /// Of the pictures in a folder.
    const io::ImageFormat* format = io::find_image_format_named("TIFF");
    ResumeOptions resume{.resume = false, .every = std::chrono::minutes(1)};
    simulate::RenderOptions render;
};

/// What was rendered.
struct RenderJobResult {
    std::int64_t frames = 0;
    std::int64_t lost = 0;             ///< frames that the camera lost
    std::int64_t kept = 0;             ///< frames that an interrupted run had rendered
    double particles_mean = 0;         ///< in view, per frame
    double scale = 0;                  ///< [px per diameter]
    std::optional<double> frame_rate;  ///< [1/s]; empty: unknown
    double ms_per_frame = 0;           ///< to render, of those rendered now; so `optics`
    double write_ms_per_frame = 0;
    OpticsUse optics;
    int signal = 0;  ///< that ended it early; 0: none
};

/// Says in the plan what render_frames would do. Throws as that does.
void plan_rendering(const RenderJobOptions& options, Job& job);

/// Renders the snapshots that the camera sees into frames, and their true positions. Stopped by a
/// signal, the frames rendered so far are a complete output, and a checkpoint beside it is what
/// `resume` goes on from (Resumable, KeptFrames): frames and truth in the end are those of a run
/// that was not stopped. Throws OptionError, InputError, OutputError.
RenderJobResult render_frames(const RenderJobOptions& options, Job& job);

/// The snapshots nearest to the instants of a camera of `rate` [1/s] which sees the first one, of a
/// series of `count` taken `interval` [s] apart. Throws OptionError if the camera is faster.
std::vector<std::int64_t> snapshots_at_rate(std::int64_t count, double interval, double rate);

}  // namespace grainfield::pipelines
