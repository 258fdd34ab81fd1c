#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "core/box.h"
#include "core/trajectory.h"

namespace grainfield::io {

/// What the columns of a table of points cannot say. It stands in comment lines
///
///     # grainfield points 1
///     # length_unit: pixel
///     # diameter: 10.09
///     # frame_rate: 500
///     # box: -0.5,-0.5,1012,1012,0        (origin, length, height between the plates)
///     # boundary: walls,walls
///
/// in a file beside the table (statement_path), so that any reader sees an ordinary table, or
/// before its header line.
struct PointsStatement {
    TrajectoryInfo info;
    std::optional<Box> box;     ///< none if it changes with time
    bool has_diameter = false;  ///< the comments state it
};

/// The file that states it for a table without comments of its own: "tracks.csv.meta".
std::filesystem::path statement_path(const std::filesystem::path& table);

/// The comment lines, each with its line feed.
std::string text_of(const PointsStatement& statement);

/// "# frame 7 time 0.014" and a line feed for a frame that the lines of its points do not describe:
/// its time is not frame / frame rate (frame number without a rate), or it has no points. Else
/// nothing.
std::string frame_comment(const Snapshot& snapshot, const TrajectoryInfo& info);

/// Takes the comment lines of a table one by one. Comments of other programs mean nothing: only
/// those that follow "# grainfield points 1" are read.
class PointsStatementReader {
 public:
    explicit PointsStatementReader(TrajectoryInfo info)
        : statement_{.info = std::move(info), .box = {}} {}

    /// Returns what is wrong with the line, empty if nothing.
    std::string take(std::string_view line);

    const PointsStatement& statement() const { return statement_; }
    /// Whether a line was "# grainfield points 1".
    bool is_ours() const { return is_ours_; }

    struct FrameTime {
        std::int64_t frame = 0;
        double time = 0;
    };
    /// What the last line said about a frame, if it did.
    const std::optional<FrameTime>& frame_time() const { return frame_time_; }

 private:
    std::string take_frame(std::string_view text);
    std::string take_value(std::string_view key, std::string_view value);

    PointsStatement statement_;
    bool is_ours_ = false;
    std::optional<FrameTime> frame_time_;
};

}  // namespace grainfield::io
