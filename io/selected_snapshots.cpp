#include "io/selected_snapshots.h"

#include "io/images/picture.h"

namespace grainfield::io {

SelectedSnapshots::SelectedSnapshots(SnapshotSource& source, const FrameSelection& selection)
    : source_(source), selection_(selection) {}

Snapshot SelectedSnapshots::read(std::int64_t position) {
    require_frame_index(position, selection_.count, "selected snapshots");
    return source_.read(selection_.first + position * selection_.step);
}

SelectedFields::SelectedFields(FieldSource& source, const FrameSelection& selection)
    : source_(source), selection_(selection) {}

FieldFrame SelectedFields::read(std::int64_t position) {
    require_frame_index(position, selection_.count, "selected fields");
    return source_.read(selection_.first + position * selection_.step);
}

}  // namespace grainfield::io
