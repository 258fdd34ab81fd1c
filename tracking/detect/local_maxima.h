#pragma once

#include <vector>

#include "core/frame.h"
#include "core/vec2.h"

namespace grainfield::tracking {

/// A local maximum of a map, refined to sub-pixel by a parabola per axis.
struct Peak {
    Vec2 position;  ///< [px]
    float value = 0;
};

/// Pixels larger than `threshold` and than their eight neighbours (the first in reading order on
/// plateaus), at least `separation` apart: of two closer peaks the higher one stays. Sorted by
/// value, highest first; ties by position. O(pixels + peaks log peaks) where no more than a few
/// peaks lie within `separation` of one.
std::vector<Peak> local_maxima(const Image& map, float threshold, double separation);

}  // namespace grainfield::tracking
