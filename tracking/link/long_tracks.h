#pragma once

#include <cstdint>
#include <deque>
#include <unordered_map>

#include "core/support/number_archive.h"
#include "core/trajectory.h"

namespace grainfield::tracking {

/// Passes on the particles of tracks that were seen in at least `minimum_length` frames.
///
/// A snapshot waits until each of its tracks either is long enough or has ended (missing for more
/// than `memory` frames). It is then passed on without the short ones. Its frame index stays even
/// if no particle is left. Identities are not renumbered. At most (minimum_length − 1)(memory + 1)
/// + 1 consecutive frames wait, so memory does not grow with the video; a minimum length of 1
/// passes everything on at once.
class LongTracks : public SnapshotSink {
 public:
    /// The sink must outlive the filter.
    LongTracks(SnapshotSink& sink, int minimum_length, int memory);

    void write(const Snapshot& snapshot) override;

    /// No more frames come: tracks that are still short have ended. Call it before the sink closes.
    void finish();

    std::size_t waiting() const { return waiting_.size(); }

    /// Saves or restores what waits and what is known of its tracks.
    void transfer(NumberArchive& archive);

 private:
    struct Seen {
        std::int64_t times = 0;
        std::int64_t last = 0;
    };
    bool is_long(std::int64_t id) const { return seen_.at(id).times >= minimum_length_; }
    bool is_decided(const Snapshot& snapshot) const;
    void release();
    void forget();

    SnapshotSink& sink_;
    std::int64_t minimum_length_, memory_;
    std::int64_t frame_ = 0;
    std::deque<Snapshot> waiting_;
    std::unordered_map<std::int64_t, Seen> seen_;  ///< tracks alive or waiting
};

}  // namespace grainfield::tracking
