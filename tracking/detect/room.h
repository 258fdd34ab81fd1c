#pragma once

#include <vector>

#include "core/vec2.h"
#include "tracking/layers/overlap_graph.h"

namespace grainfield::tracking {

/// Whether a sphere at `place` fits between the plates beside `neighbours`, all those nearer than
/// a.
///
/// It does if the rise δ over each of them stays below H, and so does the sum of the two smaller
/// rises of every three spheres that overlap one another. Distances may be too short by `granted`.
///
///     δ = sqrt(1 − (d/a + granted)²) [a]
///
/// Positions in px, `granted` in a. O(n²) for n neighbours. Parallax is left out.
bool has_room(const SphereCell& cell, Vec2 place, const std::vector<Vec2>& neighbours,
              double granted);

}  // namespace grainfield::tracking
