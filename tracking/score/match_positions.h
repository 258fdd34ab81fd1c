#pragma once

#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// Pairs found positions with true ones: one-to-one, the nearest pairs first, none farther apart
/// than `gate` [px]. Per true position the index of the one found, −1 if there is none.
/// Deterministic: equal distances go to the smaller indices. Cost O(N log N) at bounded density.
std::vector<int> match_positions(const std::vector<Vec2>& found, const std::vector<Vec2>& truth,
                                 double gate);

}  // namespace grainfield::tracking
