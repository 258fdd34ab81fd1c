#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/snapshot.h"
#include "core/trajectory.h"

namespace grainfield::analysis {

/// One instant as every observable takes it: particles with finite positions, lengths in units of
/// the particle diameter a, positions inside the box on periodic axes.
struct Pattern {
    std::int64_t frame = 0;        ///< index in the source; gaps keep their index
    double time = 0;               ///< [time unit of the trajectory]
    Box box;                       ///< [a]
    std::vector<Vec2> position;    ///< [a]
    std::vector<std::int64_t> id;  ///< identity, parallel to `position`; empty: not linked
    std::vector<double> z;         ///< height of the centre [a]; NaN: not known; empty: none is
    std::int64_t dropped = 0;      ///< particles left out because a coordinate is not finite

    std::size_t size() const { return position.size(); }
};

/// A height whose standard error is larger says no more than that the particle lies between the
/// plates, and counts as not known [a].
inline constexpr double largest_height_error = 0.2;

/// The pattern of a snapshot: r = r_source / diameter. A height is known where it is finite and its
/// standard error, if there is one, at most `largest_height_error`.
/// `diameter` [length unit of the snapshot] > 0. Cost O(N).
/// Throws InputError if the columns of the snapshot have different lengths or the box is invalid.
Pattern pattern_of(const Snapshot& snapshot, double diameter);

/// The divisor that turns the lengths of a trajectory into units of a.
/// Throws InputError unless it is finite and positive.
double diameter_of(const TrajectoryInfo& info);

}  // namespace grainfield::analysis
