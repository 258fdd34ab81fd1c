#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/snapshot.h"

namespace grainfield {

/// What no snapshot of a trajectory has, and which particle has it.
struct SnapshotFlaw {
    std::size_t particle = 0;  ///< its place in the snapshot
    std::string actual;        ///< "it is at (nan, 3)"
    std::string expected;
};

/// How many lengths of the box beside it a position is still believed, for trajectories that were
/// not folded back into it.
constexpr double farthest_box = 10;

/// Looks for what is no measurement, in files of any kind, snapshot after snapshot: coordinates
/// that are not finite, positions more than `farthest_box` lengths of the box beside it, identities
/// that occur twice. O(N) a snapshot; keeps a number for each identity below four million.
class SnapshotCheck {
 public:
    /// The first flaw, if there is one.
    std::optional<SnapshotFlaw> flaw_of(const Snapshot& snapshot);

 private:
    std::optional<std::size_t> repeated(const std::vector<std::int64_t>& id);

    std::vector<std::uint32_t> seen_;  ///< by identity: the round in which it was seen last
    std::uint32_t round_ = 0;
};

/// The first index whose time is not after the one before it.
std::optional<std::size_t> first_not_growing(std::span<const double> times);

/// "particle 7", by its identity, or by its place where there are none.
std::string particle_name(const Snapshot& snapshot, std::size_t particle);

}  // namespace grainfield
