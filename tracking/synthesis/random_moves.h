#pragma once

#include <cstdint>
#include <vector>

#include "tracking/synthesis/mirror_optics.h"

namespace grainfield::tracking {

/// Another arrangement like this one: hard spheres of diameter 1 between plates, moved at random.
///
/// `sweeps` times each sphere is offered a place within ±`step` of its own in x, y and z [a]. It
/// takes it where that makes no overlap larger. Spheres within half a diameter of the bounding box
/// of all stay, so that none escape. Heights stay within 0 and `top`. The same seed and stream give
/// the same spheres. O(spheres · sweeps).
std::vector<Point3> moved_at_random(std::vector<Point3> spheres, double top, double step,
                                    int sweeps, std::uint64_t seed, std::uint64_t stream);

}  // namespace grainfield::tracking
