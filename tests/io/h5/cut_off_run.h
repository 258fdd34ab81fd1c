#pragma once

#include <filesystem>
#include <string>

#include "io/h5/trajectory_file.h"
#include "tests/io/h5/cut_column.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {

/// What a run leaves that is killed while it writes: a trajectory of two particles and four frames
/// whose times end after the first one. Returns its path.
inline std::string write_cut_off_run(const testing::ScratchFolder& folder) {
    std::string left = folder / "left.h5";
    {
        TrajectoryWriter writer(folder / "t.h5", TrajectoryInfo{}, Overwrite::force);
        Snapshot snapshot;
        snapshot.box.length = {100, 100};
        snapshot.position = {{10, 10}, {30, 40}};
        for (snapshot.frame = 0; snapshot.frame < 4; ++snapshot.frame) {
            snapshot.time = static_cast<double>(snapshot.frame);
            writer.write(snapshot);
        }
        std::filesystem::copy_file(folder / "t.h5.partial", left);
    }
    cut_column(left, "/particles/trajectory/position/time", 1);
    return left;
}

}  // namespace grainfield::io
