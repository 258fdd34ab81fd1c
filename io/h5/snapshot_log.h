#pragma once

#include <cstdint>
#include <vector>

#include "core/support/snapshot_numbers.h"
#include "core/trajectory.h"
#include "io/h5/record_log.h"

namespace grainfield::io {

/// The snapshots that a run under way has stored so far, one record each: an HDF5 file that was not
/// closed cannot be cut back to a checkpoint. All columns, eight bytes a number.
class SnapshotLog : public SnapshotSink {
 public:
    /// `log` must outlive this.
    explicit SnapshotLog(RecordLog& log) : log_(log) {}

    void write(const Snapshot& snapshot) override {
        NumberArchive archive;
        Snapshot copy = snapshot;
        archive(copy);
        log_.append(archive.take_numbers());
    }
    std::int64_t count() const { return log_.count(); }
    Snapshot read(std::int64_t index) const {
        const std::vector<double> numbers = log_.read(index);
        NumberArchive archive(numbers);
        Snapshot snapshot;
        archive(snapshot);
        archive.require_end();
        return snapshot;
    }

 private:
    RecordLog& log_;
};

}  // namespace grainfield::io
