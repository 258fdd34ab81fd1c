#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/box.h"
#include "core/trajectory.h"

namespace grainfield::io {

/// Reads points from a table with a header line, of grainfield or any other tracker.
///
/// Columns `frame`, `x`, `y` must be there; `particle`, `z`, `x_std`, `y_std`, `layer`, `quality`
/// may be; order, upper case, spaces, other columns, CRLF and a byte-order mark do not matter.
/// Empty fields are missing values (allowed in z, x_std, y_std, quality: NaN, and layer: unknown).
/// Lines may be in any order; snapshots are in order of frame, each in order of its lines.
///
/// `hints` is what the table cannot say (units, diameter, frame rate): time = frame / frame_rate if
/// that is given, else frame. Without a box, it is the bounding box of all points, with walls.
///
/// The table is held in memory, about 100 bytes a line. Throws InputError with the line number and
/// the field if a number cannot be read, a column is missing or occurs twice.
std::unique_ptr<SnapshotSource> open_points(const std::filesystem::path& path,
                                            const std::optional<Box>& box,
                                            const TrajectoryInfo& hints);

}  // namespace grainfield::io
