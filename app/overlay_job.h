#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "app/command.h"
#include "core/trajectory.h"
#include "io/output_file.h"

namespace grainfield::app {

struct OverlayRequest {
    std::string output;         ///< video to write
    std::string film;           ///< video or folder that was tracked; empty: as the record says
    std::int64_t trail = 25;    ///< frames that a trail reaches back
    std::optional<double> fps;  ///< of the video; empty: as filmed, 25 above 60
};

/// Draws every snapshot of a trajectory over its frame (report::Overlay) into a video. The film is
/// the one named, or those inputs of the recorded run that are still there; without a film the
/// particles are drawn on white, and a warning says so where there should be one. Stopped by a
/// signal, the frames drawn so far are a complete video. Throws InputError, OptionError,
/// OutputError.
Summary write_overlay(Session& session, SnapshotSource& snapshots, const RunRecord* record,
                      const OverlayRequest& request, io::Overwrite overwrite);

}  // namespace grainfield::app
