#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "core/box.h"
#include "core/trajectory.h"
#include "io/text/points_line.h"

namespace grainfield::io {

/// Reads points from a table with a header line, of grainfield or any other tracker.
///
/// Columns `frame`, `x`, `y` must be there (a `frame` that is not: see FrameColumn; `x_px`, `y_px`
/// are x and y in pixels); `particle`, `z`, `x_std`, `y_std`, `z_std`, `layer`,
/// `quality` may be; order, upper case, spaces, other columns, CRLF and a byte-order mark do not
/// matter.
/// Empty fields are missing values (NaN, or layer unknown); a column without any value in a frame
/// is left out of that frame. `particle` is given for all points of a frame or for none, and each
/// identity once. Layers are 0 and 1, or 1 and 2. Lines may be in any order; snapshots are in order
/// of frame, each in order of its lines. Lines that start with # are comments; those of
/// grainfield's own tables (PointsStatement) are read; where it has none, those of
/// `statement_path(path)` if that file is there. What they say about units, diameter, times and the
/// box overrides the hints.
///
/// `hints` is what the table cannot say (units, diameter, frame rate): time = frame / frame_rate if
/// that is given, else frame. Without a box, it is the one that the comments state, else the
/// bounding box of all points, with walls. A given box takes origin and boundaries of a stated one.
///
/// On opening, the whole table is read and checked once. Frames are then read again one by one.
/// Memory holds one frame and 24 bytes for each change of frame from line to line. Throws
/// InputError with the line number and the field if a number cannot be read, a column is missing or
/// occurs twice, a particle occurs twice in neighbouring lines of a frame. `read` throws it if the
/// file has changed since, or a particle occurs twice in a frame whose lines are scattered.
std::unique_ptr<SnapshotSource> open_points(const std::filesystem::path& path,
                                            const std::optional<Box>& box,
                                            const TrajectoryInfo& hints,
                                            FrameColumn frames = FrameColumn::required);

/// Whether the comments before the header line, or the file beside it, state the diameter of the
/// particles.
bool states_diameter(const std::filesystem::path& path);

/// Whether the comments before the header line, or the file beside it, state a box.
bool states_box(const std::filesystem::path& path);

}  // namespace grainfield::io
