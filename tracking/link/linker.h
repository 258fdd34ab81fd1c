#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/option_table.h"
#include "core/vec2.h"

namespace grainfield::tracking {

struct LinkOptions {
    std::optional<double> search_range;  ///< [px] largest step between frames; empty: D/2
    int memory = 2;                      ///< [frames] a sphere may be missing this long
};

OptionTable describe(LinkOptions& options);

struct LinkSummary {
    std::int64_t linked = 0;       ///< steps that continued a track
    std::int64_t started = 0;      ///< tracks begun, those of the first frame included
    std::int64_t ended = 0;        ///< tracks given up
    std::int64_t bridged = 0;      ///< steps across one or more missing frames
    double squared_steps = 0;      ///< Σ |step|² of steps between consecutive frames [px²]
    std::int64_t consecutive = 0;  ///< number of those steps
};

/// Gives particles their identity through time, frame by frame.
///
/// Every pair (track, particle) within the search range is a candidate; pairs are taken nearest
/// first, ties by track and particle index, each track and particle once (the limit of the
/// Crocker–Grier cost `crocker1996` for steps well below the spacing). Memory holds the tracks that
/// may still come back, not the past. Candidates by a cell grid: O(N) a frame at fixed density,
/// plus a sort of the candidates.
class Linker {
 public:
    Linker(double search_range, int memory);

    /// Identities of the particles of the next frame, in their order. Frames must come in order;
    /// `frame` numbers that are left out count as missing for the memory.
    std::vector<std::int64_t> link(std::int64_t frame, const std::vector<Vec2>& positions);

    const LinkSummary& summary() const { return summary_; }

 private:
    struct Track {
        std::int64_t id;
        std::int64_t frame;  ///< last seen
        Vec2 position;
    };

    double search_range_;
    int memory_;
    std::vector<Track> tracks_;
    std::int64_t next_id_ = 0;
    LinkSummary summary_;
};

}  // namespace grainfield::tracking
