#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/option_table.h"
#include "core/vec2.h"
#include "tracking/link/candidates.h"
#include "tracking/link/motion.h"
#include "tracking/link/subnets.h"

namespace grainfield::tracking {

struct LinkOptions {
    std::optional<double> search_range;  ///< [px] largest step between frames; empty: adapts
    int memory = 2;                      ///< [frames] a sphere may be missing this long
    Predictor predictor = Predictor::none;
    int minimum_length = 1;  ///< [frames] shorter tracks are not written (LongTracks)
    std::int64_t largest_subnet = 1000000;  ///< [pairs] solved to the optimum
};

OptionTable describe(LinkOptions& options);

struct LinkSummary {
    std::int64_t linked = 0;          ///< steps that continued a track
    std::int64_t started = 0;         ///< tracks begun, those of the first frame included
    std::int64_t ended = 0;           ///< tracks given up
    std::int64_t bridged = 0;         ///< steps across one or more missing frames
    std::int64_t bridged_frames = 0;  ///< frames missing in those
    std::int64_t merged = 0;          ///< tracks lost while another took what was in their reach
    std::int64_t split = 0;           ///< tracks begun within reach of one that went elsewhere
    std::int64_t consecutive = 0;     ///< steps between consecutive frames
    double squared_steps = 0;         ///< Σ |displacement|² of those [px²]
    double squared_misses = 0;        ///< Σ |position − prediction|² of those [px²]
    std::int64_t crowded = 0;         ///< times a track had more particles in reach than are kept
    double range = 0;                 ///< search range of the last frame [px]
    SubnetCounts subnets;
};

/// All that the next frame needs to know of those before it. Bounded by the particles of the last
/// memory + 1 frames, whatever the length of the video.
struct LinkState {
    std::vector<Track> tracks;  ///< alive, by id
    std::int64_t next_id = 0;
    std::optional<std::int64_t> frame;  ///< the last one linked
    Vec2 drift;                         ///< median velocity of the last frame [px/frame]
    double motion = 0;  ///< variance of the steps of the last frame per axis [px²]; 0: unknown
    LinkSummary summary;
};

/// Gives particles their identity through time, frame by frame.
///
/// Crocker and Grier's criterion: of all ways to join tracks and particles not farther apart than
/// the search range R, take the one that minimises
///
///     Σ_{links} cost + R² · (tracks without a link)                 `crocker1996`,
///
/// cost = d², or weighted by the standard errors of both positions (StepCost), d the distance from
/// the predicted place. The minimum is exact (choose_links) unless a subnet exceeds
/// `largest_subnet` pairs or a track has more than 32 particles in reach; both are counted and
/// warned of. A search range that is not given follows the motion,
///
///     R = 4.5 s, at least D/2, at most D,
///
/// s the standard deviation of a step per axis in the frame before (one step in 25,000 is longer).
/// A frame whose own steps need a larger R is linked once more with that. So is one in which more
/// tracks lie within D of a new particle, or within D/4 if they made their last step again, than
/// chance puts there with R = D: a few fast particles among many slow ones. Memory holds the tracks
/// that may still come back, not the past. Deterministic; costs that are equal go to the older
/// track and the earlier particle. About 2 ms for 11,700 particles whose steps are small against
/// their spacing.
class Linker {
 public:
    /// `diameter` D [px] is needed only if `options.search_range` is not set. Throws OptionError if
    /// neither is a positive length.
    explicit Linker(const LinkOptions& options, double diameter = 0);

    /// Identities of the particles of the next frame, in their order. Frames must come in order;
    /// `frame` numbers that are left out count as missing for the memory. `errors`: standard
    /// errors per axis [px], none or one a particle; not finite or negative: taken as the RMS
    /// one; above the least search range: as that. Throws InputError if frames come out of order, a
    /// position is not finite, or the number of errors is wrong, and leaves the state as it was.
    std::vector<std::int64_t> link(std::int64_t frame, const std::vector<Vec2>& positions,
                                   const std::vector<Vec2>& errors = {});

    const LinkSummary& summary() const { return state_.summary; }

    /// For a run that goes on later: link() after restore(state()) gives the same identities.
    const LinkState& state() const { return state_; }
    void restore(LinkState state) { state_ = std::move(state); }

    /// What a user should know: steps too long for the diameter [px], searches that were bounded.
    std::vector<std::string> warnings(double diameter) const;

 private:
    /// How a frame is linked, before it becomes part of the state.
    struct Choice {
        double range = 0;
        Candidates candidates;
        std::vector<std::int32_t> links;  ///< particle of each track, −1: none
        SubnetCounts counts;
        double motion = 0;  ///< seen in these links; 0: there are none
    };
    Choice choose(std::int64_t frame, const Places& predicted, const Places& particles,
                  double range) const;
    bool has_long_steps(std::int64_t frame, const Choice& choice, const Places& predicted,
                        const Places& particles) const;
    double range_for(double motion, double squared_error) const;
    void forget(std::int64_t frame);
    void follow(std::int64_t frame, const Choice& choice, const Places& predicted,
                const Places& particles);
    void count_rivals(std::int64_t frame, const Choice& choice,
                      const std::vector<std::int64_t>& ids);

    LinkOptions options_;
    double least_range_, most_range_;  ///< [px]; equal if the user gave one
    LinkState state_;
};

}  // namespace grainfield::tracking
