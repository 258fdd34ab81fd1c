#include "tracking/link/long_tracks.h"

#include <algorithm>
#include <vector>

#include "core/support/snapshot_numbers.h"

namespace grainfield::tracking {
namespace {

template <class T>
void keep(std::vector<T>& column, const std::vector<char>& wanted) {
    if (column.empty()) return;
    std::size_t next = 0;
    for (std::size_t i = 0; i < wanted.size(); ++i) {
        if (wanted[i]) column[next++] = column[i];
    }
    column.resize(next);
}

void keep_particles(Snapshot& s, const std::vector<char>& wanted) {
    keep(s.position, wanted);
    keep(s.id, wanted);
    keep(s.z, wanted);
    keep(s.velocity, wanted);
    keep(s.spin, wanted);
    keep(s.position_error, wanted);
    keep(s.z_error, wanted);
    keep(s.quality, wanted);
    keep(s.layer, wanted);
}

}  // namespace

LongTracks::LongTracks(SnapshotSink& sink, int minimum_length, int memory)
    : sink_(sink), minimum_length_(minimum_length), memory_(memory) {}

void LongTracks::write(const Snapshot& snapshot) {
    if (minimum_length_ <= 1) {
        sink_.write(snapshot);
        return;
    }
    frame_ = snapshot.frame;
    for (const std::int64_t id : snapshot.id) {
        Seen& seen = seen_[id];
        ++seen.times;
        seen.last = frame_;
    }
    waiting_.push_back(snapshot);
    while (!waiting_.empty() && is_decided(waiting_.front())) release();
    forget();
}

void LongTracks::finish() {
    while (!waiting_.empty()) release();
    forget();
    seen_.clear();
}

bool LongTracks::is_decided(const Snapshot& snapshot) const {
    return std::all_of(snapshot.id.begin(), snapshot.id.end(), [&](std::int64_t id) {
        const Seen& seen = seen_.at(id);
        return seen.times >= minimum_length_ || frame_ - seen.last > memory_;
    });
}

void LongTracks::release() {
    Snapshot& snapshot = waiting_.front();
    std::vector<char> wanted(snapshot.size(), 1);
    for (std::size_t i = 0; i < snapshot.id.size(); ++i) wanted[i] = is_long(snapshot.id[i]);
    keep_particles(snapshot, wanted);
    sink_.write(snapshot);
    waiting_.pop_front();
}

/// Drops what no waiting snapshot and no later one can ask for.
void LongTracks::forget() {
    const std::int64_t oldest = waiting_.empty() ? frame_ + 1 : waiting_.front().frame;
    std::erase_if(seen_, [&](const auto& entry) {
        const Seen& seen = entry.second;
        return frame_ - seen.last > memory_ && seen.last < oldest;
    });
}

void LongTracks::transfer(NumberArchive& archive) {
    archive(frame_);
    archive.list(waiting_);
    std::vector<double> seen;
    for (const auto& [id, track] : seen_) {
        for (const std::int64_t n : {id, track.times, track.last}) {
            seen.push_back(static_cast<double>(n));
        }
    }
    archive(seen);
    seen_.clear();
    for (std::size_t i = 0; i + 2 < seen.size(); i += 3) {
        seen_[static_cast<std::int64_t>(seen[i])] = {static_cast<std::int64_t>(seen[i + 1]),
                                                     static_cast<std::int64_t>(seen[i + 2])};
    }
}

}  // namespace grainfield::tracking
