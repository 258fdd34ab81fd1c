#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "core/support/snapshot_numbers.h"
#include "core/trajectory.h"
#include "io/h5/record_log.h"

namespace grainfield::io {

/// The snapshots that a run under way has written so far (RecordLog): an HDF5 file that was not
/// closed cannot be cut back to a checkpoint. Six doubles a particle.
class SnapshotLog : public SnapshotSink {
 public:
    /// Keeps the first `bytes` of what is there; 0 starts afresh.
    SnapshotLog(std::filesystem::path path, std::int64_t bytes) : log_(std::move(path), bytes) {}

    void write(const Snapshot& snapshot) override {
        NumberArchive archive;
        Snapshot copy = snapshot;
        archive(copy);
        log_.append(archive.take_numbers());
    }
    std::int64_t bytes() const { return log_.bytes(); }
    /// Brings it to the disk; before the checkpoint that notes its length.
    void sync() { log_.sync(); }
    void remove() { log_.remove(); }

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
    RecordLog log_;
};

}  // namespace grainfield::io
