#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "core/snapshot.h"

namespace grainfield::simulate {

/// How a grain of one frame is related to the last one seen under the same identity.
enum class Sighting : std::uint8_t {
    first,   ///< never seen before
    same,    ///< goes on
    another  ///< the frames do not show that it is the same one
};

/// Whether a grain that leaves the frame and comes back counts as the same one.
enum class Absence : std::uint8_t { keeps, ends };

/// For how long one can follow a grain: until it crosses a periodic boundary, when it is seen to
/// leave on one side and another one to come in on the other (else its displacement would be the
/// box); with Absence::ends also until it leaves the frame. The sign of a crossing is a step of
/// more than half of `span` on an axis since it was last seen. The one rule for the identities of
/// rendered frames and for the scores of tracks.
class Continuity {
 public:
    /// `span` [px]: of the frame, or of the period if that is shorter (Renderer::crossing_span).
    Continuity(Vec2 span, Absence absence) : span_(span), absence_(absence) {}

    /// The next frame; one sighting a particle. Identities are different from one another.
    std::vector<Sighting> follow(const std::vector<std::int64_t>& id,
                                 const std::vector<Vec2>& position);

 private:
    struct Seen {
        std::int64_t frame;
        Vec2 position;
    };
    Vec2 span_;
    Absence absence_;
    std::int64_t frame_ = 0;
    std::unordered_map<std::int64_t, Seen> last_;
};

/// Gives the true positions of frames identities that hold for as long as one can follow a grain
/// (Continuity, Absence::keeps): 2^40 more at every crossing.
class LastingIds {
 public:
    explicit LastingIds(Vec2 span) : continuity_(span, Absence::keeps) {}

    /// The next frame in the order of time. Without ids no grain is followed.
    void follow(const Snapshot& truth);
    std::int64_t followed() const { return followed_; }
    /// Renumbers `truth.id`, of the frame that was followed as number `frame` (0, 1, …), in any
    /// order.
    void renumber(Snapshot& truth, std::int64_t frame) const;

 private:
    Continuity continuity_;
    std::int64_t followed_ = 0;
    std::unordered_map<std::int64_t, std::vector<std::int64_t>> crossings_;  // frames, rising
};

}  // namespace grainfield::simulate
