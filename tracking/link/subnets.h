#pragma once

#include <cstdint>
#include <vector>

#include "tracking/link/assignment.h"

namespace grainfield::tracking {

/// How ambiguous the links of a frame, or of a whole run, were.
struct SubnetCounts {
    std::int64_t subnets = 0;        ///< groups in which tracks or particles compete
    std::int64_t largest = 0;        ///< most tracks in one of them
    std::int64_t largest_pairs = 0;  ///< most pairs in one of them
    std::int64_t reduced = 0;        ///< too large: not solved to the optimum

    void add(const SubnetCounts& other);
};

/// Chooses the links: the pairs of least total cost, each track and particle once, where a track
/// without a link costs `leave`.
///
/// Pairs that compete with no other are links. The rest falls into connected groups ("subnets"),
/// each solved to the optimum by AssignmentSolver. A subnet of more than `largest` pairs is first
/// cut: its pairs are limited to √0.8, 0.8, … of the range until the pieces fit, every piece is
/// solved to its optimum, and the pairs cut off are then taken cheapest first among those still
/// free. No frame is refused; `counts.reduced` says how often that happened.
///
/// Pairs must be sorted by track. Returns the particle of each track, −1 for none. Cost O(pairs)
/// and the assignment of the subnets. Deterministic.
std::vector<std::int32_t> choose_links(const std::vector<AssignmentPair>& pairs,
                                       std::uint32_t tracks, std::uint32_t particles, double leave,
                                       std::int64_t largest, SubnetCounts& counts);

}  // namespace grainfield::tracking
