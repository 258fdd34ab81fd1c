#pragma once

#include <cstdint>

#include "core/density_field.h"
#include "core/trajectory.h"
#include "io/frame_range.h"

namespace grainfield::io {

/// Some snapshots of another source, which must outlive it. `read(position)` counts within the
/// selection; a snapshot keeps the frame number and time it has in the source. `read` throws
/// OptionError if the position is outside [0, count()).
class SelectedSnapshots : public SnapshotSource {
 public:
    SelectedSnapshots(SnapshotSource& source, const FrameSelection& selection);

    const TrajectoryInfo& info() const override { return source_.info(); }
    std::int64_t count() const override { return selection_.count; }
    Snapshot read(std::int64_t position) override;

 private:
    SnapshotSource& source_;
    FrameSelection selection_;
};

/// The same of a series of fields.
class SelectedFields : public FieldSource {
 public:
    SelectedFields(FieldSource& source, const FrameSelection& selection);

    std::int64_t count() const override { return selection_.count; }
    FieldFrame read(std::int64_t position) override;

 private:
    FieldSource& source_;
    FrameSelection selection_;
};

}  // namespace grainfield::io
