#include "io/open_snapshots.h"

#include <string>

#include <fmt/format.h>

#include "core/errors.h"
#include "io/file_kind.h"
#include "io/h5/trajectory_file.h"
#include "io/text/points_csv.h"

namespace grainfield::io {

namespace {

[[noreturn]] void refuse(const std::filesystem::path& path, const char* actual) {
    throw InputError({.problem = fmt::format("cannot take particles from '{}'", path.string()),
                      .actual = actual,
                      .expected = "an H5MD trajectory (.h5) or a table of points (.csv) with the "
                                  "columns frame,x,y",
                      .suggestion = {}});
}

}  // namespace

std::unique_ptr<SnapshotSource> open_snapshots(const std::filesystem::path& path,
                                               const std::optional<Box>& box,
                                               const TrajectoryInfo& hints, FrameColumn frames) {
    switch (identify(path)) {
        case FileKind::trajectory:
            return std::make_unique<TrajectoryFile>(path);
        case FileKind::points:
            return open_points(path, box, hints, frames);
        case FileKind::results:
            refuse(path, "it holds results of an analysis");
        case FileKind::field:
            refuse(path, "it holds density fields");
        case FileKind::unknown:
            break;
    }
    // Named as a table, it is told what is missing in it.
    if (path.extension() == ".csv") return open_points(path, box, hints, frames);
    refuse(path, "it holds no particles; pictures and videos are for 'grainfield track'");
}

}  // namespace grainfield::io
