#pragma once

#include <cstdint>
#include <vector>

#include "tracking/synthesis/synthesis_fit.h"

namespace grainfield::tracking {

/// What a search for a better arrangement did.
struct ArrangementChanges {
    int places = 0;  ///< looked at
    int trials = 0;  ///< arrangements tried
    int lifted = 0;  ///< spheres that changed their height
    int added = 0, removed = 0;
};

/// Tries other arrangements where image and rendering differ unusually.
///
/// Gauss–Newton ends in the nearest minimum: with spheres in the wrong order of height, or three
/// found as two. About each place in question the spheres within 1.3 a are fitted again from other
/// starts, all others fixed: from `discs`, the start, with heights in turns as overlaps in the
/// picture demand; one of them at another height, one more on a dark spot of the residual, one
/// less, one moved there. Those with the least misfit are fitted with few rays, the best of them
/// again with all. The arrangement with the least misfit and overlap stays if it gains more than 6
/// times the misfit that is usual about a sphere. Places of one round are 3.6 a apart and
/// independent. Changes `spheres` only. The ranges and counts were chosen by trial on ray-traced
/// frames; they are not derived.
ArrangementChanges improve_arrangement(const Image& brightness, const Image& ceiling,
                                       const SynthesisFit& fit, const std::vector<Point3>& discs,
                                       double scale, const SynthesisLimits& limits, int threads,
                                       std::vector<Point3>& spheres);

}  // namespace grainfield::tracking
