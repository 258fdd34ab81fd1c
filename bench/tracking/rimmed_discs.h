#pragma once

#include <span>

#include "core/frame.h"
#include "core/support/random.h"
#include "core/vec3.h"

namespace grainfield::bench {

/// A frame of opaque discs with a bright rim, seen by a camera that is drawn at random.
///
/// Discs have .84–1.02 a, cores .6–.95 of that. Rims have 0–.9 of the bright field, faint ones more
/// often, and are even or brighter outwards. Blur is .02–.13 a, noise .5–5 % (logarithmic). Stray
/// light is 3 %, the bright field .8 of full scale. Higher spheres hide lower ones. 8 bit, cut at
/// 0.
///
/// `spheres`: x and y [px], z in any unit. `scale`: a [px].
Image rimmed_discs(std::span<const Vec3> spheres, double scale, int width, int height,
                   RandomStream& random);

}  // namespace grainfield::bench
