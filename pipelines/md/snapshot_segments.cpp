#include "pipelines/md/snapshot_segments.h"

#include <limits>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "core/support/interrupt.h"

namespace grainfield::pipelines {

SnapshotSegments::SnapshotSegments(std::filesystem::path output, TrajectoryInfo info,
                                   std::int64_t existing)
    : output_(std::move(output)), info_(std::move(info)), count_(existing) {}

std::filesystem::path SnapshotSegments::path(std::int64_t segment) const {
    std::filesystem::path path = output_;
    path += ".segment-" + std::to_string(segment);
    return path;
}

void SnapshotSegments::write(const Snapshot& snapshot) {
    if (!writer_) writer_.emplace(path(count_), info_, io::Overwrite::force);
    writer_->write(snapshot);
}

void SnapshotSegments::close() {
    if (!writer_) return;
    writer_->finish({});
    writer_.reset();
    ++count_;
}

void SnapshotSegments::merge_into(SnapshotSink& sink) {
    close();
    std::vector<std::int64_t> first(static_cast<std::size_t>(count_) + 1,
                                    std::numeric_limits<std::int64_t>::max());
    for (std::int64_t i = count_ - 1; i >= 0; --i) {
        const auto k = static_cast<std::size_t>(i);
        io::TrajectoryFile file(path(i));
        first[k] = file.count() > 0 ? std::min(file.read(0).frame, first[k + 1]) : first[k + 1];
    }
    for (std::int64_t i = 0; i < count_; ++i) {
        io::TrajectoryFile file(path(i));
        for (std::int64_t s = 0; s < file.count(); ++s) {
            const Snapshot snapshot = file.read(s);
            throw_if_interrupted("joining the snapshots");
            if (snapshot.frame < first[static_cast<std::size_t>(i) + 1]) sink.write(snapshot);
        }
    }
}

void SnapshotSegments::remove() {
    std::error_code ignored;
    for (std::int64_t i = 0; i < count_ || std::filesystem::exists(path(i), ignored); ++i) {
        std::filesystem::remove(path(i), ignored);
    }
}

}  // namespace grainfield::pipelines
