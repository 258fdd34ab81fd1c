#pragma once

#include <cstdint>
#include <unordered_map>

#include "core/snapshot.h"

namespace grainfield::simulate {

/// Gives the true positions of successive frames identities that hold for as long as one can follow
/// a grain: one that crosses a periodic boundary is seen to leave on one side and another to come
/// in on the other, and so it gets a new identity, 2^40 more (else its displacement would be the
/// box). The sign is a step of more than half of the frame on an axis since it was last seen.
class LastingIds {
 public:
    /// Renumbers `truth.id`; frames in the order of time. Does nothing without ids.
    void renumber(Snapshot& truth);

 private:
    struct Seen {
        std::int64_t id;
        Vec2 position;
    };
    std::unordered_map<std::int64_t, Seen> last_;  // by the identity of the grain
};

}  // namespace grainfield::simulate
