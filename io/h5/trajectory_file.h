#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "core/results.h"
#include "core/support/output_file.h"
#include "core/trajectory.h"

namespace grainfield::io {

/// Writes a trajectory as H5MD 1.1 (`debuyl2014`), frame by frame.
///
/// Particles stand in the group particles/trajectory: position (N × 3; third column = z if known,
/// else the layer 0/1, else 0), id, and where they apply velocity, spin, position_error, z_error,
/// quality and layer, all with the step (= frame index) and time of position. Where the number of
/// particles varies, rows beyond a frame's own have id −1 and NaN positions. The box is
/// time-dependent (3 × 3 edges; third edge = cell height, or the diameter where that is unknown).
/// What H5MD has no place for (units, box origin, record of the run, previews) is under
/// /parameters/grainfield. All data carry a Fletcher-32 checksum.
///
/// Each frame is flushed (about 0.05 ms for 11,704 particles), so that a killed run leaves all of
/// its frames but the last in the temporary file. The target appears with finish().
///
/// Throws OutputError as OutputFile does, when the disk is full, when frames come out of order, or
/// when boundaries change; InputError when a snapshot is inconsistent (require_consistent).
class TrajectoryWriter : public SnapshotSink {
 public:
    TrajectoryWriter(const std::filesystem::path& path, const TrajectoryInfo& info,
                     Overwrite overwrite);
    /// Into an output that was claimed before the work began.
    TrajectoryWriter(OutputFile output, const TrajectoryInfo& info);
    ~TrajectoryWriter() override;
    TrajectoryWriter(TrajectoryWriter&&) noexcept;

    void write(const Snapshot& snapshot) override;
    void add_preview(const Preview& preview);
    /// A table that belongs to the run, e.g. a simulation's time series; under
    /// /parameters/grainfield/curves.
    void add_curve(const Curve& curve);

    /// Adds the record of the run, closes the file and gives it its name.
    void finish(const RunRecord& record);

 private:
    struct State;
    std::unique_ptr<State> state_;
};

/// Reads an H5MD 1.1 trajectory: exactly what TrajectoryWriter wrote, or the positions, identities,
/// velocities, times and rectangular box of a file from elsewhere (info() is then the default one
/// with origin `points`).
///
/// A file of a killed run has frames, but no record. Frames at its end that lack a column are left
/// out: frames_left_out() of them, and record() has a warning of the code `incomplete`.
///
/// Rows with id < 0 or NaN position are padding and left out. Throws InputError, naming the file
/// and what is wrong with it, if it is missing, damaged, not H5MD, refers to other files (external
/// links or storage), or claims sizes that it cannot hold.
class TrajectoryFile : public SnapshotSource {
 public:
    explicit TrajectoryFile(const std::filesystem::path& path);
    ~TrajectoryFile() override;
    TrajectoryFile(TrajectoryFile&&) noexcept;

    const TrajectoryInfo& info() const override;
    std::int64_t count() const override;
    Snapshot read(std::int64_t index) override;

    const std::vector<Preview>& previews() const;
    const std::vector<Curve>& curves() const;
    const RunRecord& record() const;
    /// Of a file whose writer was killed; 0 for all others.
    std::int64_t frames_left_out() const;

 private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace grainfield::io
