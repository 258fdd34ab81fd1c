#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/box.h"
#include "core/trajectory.h"
#include "io/text/points_line.h"

namespace grainfield::io {

/// Opens what holds particles: an H5MD trajectory (TrajectoryFile; box and hints do not apply) or a
/// table of points (open_points, with `frames`). Throws InputError for anything else, saying what
/// it is.
std::unique_ptr<SnapshotSource> open_snapshots(const std::filesystem::path& path,
                                               const std::optional<Box>& box,
                                               const TrajectoryInfo& hints,
                                               FrameColumn frames = FrameColumn::required);

}  // namespace grainfield::io
