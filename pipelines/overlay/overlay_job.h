#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

#include "core/results.h"
#include "pipelines/job.h"
#include "pipelines/overlay/particle_values.h"

namespace grainfield::pipelines {

/// What an overlay is asked for; the trajectory is the first input of the job.
struct OverlayJobOptions {
    std::filesystem::path output;  ///< video to write
    /// Video, folder or pattern that was tracked; empty: as recorded; "none": on white.
    std::filesystem::path film;
    OverlayColour colour = OverlayColour::order;
    std::int64_t trail = 25;    ///< [frames] that a trail reaches back
    std::optional<double> fps;  ///< of the video [1/s]; empty: as filmed, 25 above 60
};

/// A file that a record names, as seen from anywhere: by its name, or by its name below one of the
/// folders that hold `recorder`, the file with the record, or beside that. Empty if it is nowhere
/// with the size and the checksum that were recorded. Without a recorded checksum, as of
/// interrupted runs, the size decides. Reads each file of that size and name once. Throws
/// Interrupted.
std::filesystem::path find_recorded(const RunRecord::Input& input,
                                    const std::filesystem::path& recorder);

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

/// Draws every snapshot of a trajectory over its frame (report::Overlay) into a video, with number
/// and time of the frame and a colour key below it. The film is the one named, or the inputs of the
/// recorded run (find_recorded). Without one, of simulations and points, the particles are drawn on
/// white. The output is looked at before the film. Stopped by a signal, the frames drawn so far are
/// a complete video. Throws InputError, also if the film is not found or is another one;
/// OptionError, OutputError.
OverlayJobResult draw_overlay(const OverlayJobOptions& options, Job& job);

}  // namespace grainfield::pipelines
