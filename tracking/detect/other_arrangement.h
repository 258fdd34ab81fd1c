#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec2.h"
#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

// A search ends in an arrangement that no single disc, added or removed, improves: three spheres in
// a row, fitted as two, stay two. A search with another disc stops elsewhere. Where they differ one
// of the two is better.

/// Discs of one arrangement and those of another one in their place.
struct ArrangementDifference {
    std::vector<Vec2> ours, theirs;  ///< [px]
    Vec2 low, high;                  ///< corners of the box of all of them [px]
    double change = 0;  ///< of Σ (I − M)² about them when theirs take the place of ours [contrast²]
};

/// How two arrangements of one frame differ.
struct OtherArrangement {
    std::vector<ArrangementDifference> differences;
    std::size_t unlike = 0;           ///< discs of both in clusters that hold any of theirs
    std::size_t unlike_in_large = 0;  ///< … in clusters of more than 40, which are no differences
};

/// Where `theirs` has discs without a partner within D/4 in `ours`, or ours in it: clusters of such
/// discs, 1.2 D from one to the next, in an order that depends on the positions only. D:
/// `diameter`.
OtherArrangement compare_arrangements(const std::vector<Vec2>& ours,
                                      const std::vector<Vec2>& theirs, double diameter, int width,
                                      int height);

/// Tries each difference, clusters 5 D apart at once: its discs are exchanged, they and their
/// neighbours take a few sweeps, Σ (I − M)² about them is compared, and all go back. Fills
/// `change`. With `reversed` the fit holds `theirs`. How many disc updates were done. Independent
/// of the number of threads.
std::int64_t try_differences(JointFit& fit, std::vector<ArrangementDifference>& differences,
                             bool reversed, const RefinementOptions& refinement);

/// Exchanges the discs of these differences. How many disc updates were done.
std::int64_t take_differences(JointFit& fit, const std::vector<ArrangementDifference>& differences,
                              const RefinementOptions& refinement);

}  // namespace grainfield::tracking
