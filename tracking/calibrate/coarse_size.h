#pragma once

#include <vector>

#include "core/frame.h"

namespace grainfield::tracking {

/// What the shape of the thresholded image says about discs of one size in it.
struct CoarseSize {
    double radius = 0;    ///< of inscribed discs [px]; 0: none
    double coverage = 0;  ///< share of the mask that discs of about that radius explain, 0–1
    int discs = 0;        ///< inscribed discs within 15 % of that radius
};

/// Local maxima of the distance transform are centres of inscribed discs. Spheres give discs of one
/// radius that cover most of the mask; the gaps between spheres do not, which tells the polarity.
///
/// The radii that are most frequent when discs count by their area, by their radius, and one by
/// one, in this order, each once: in dense layers, or where part of the frame has no light, a few
/// large discs hold more area than all spheres. Empty for a mask without discs.
std::vector<CoarseSize> coarse_sizes(const Image& mask);

}  // namespace grainfield::tracking
