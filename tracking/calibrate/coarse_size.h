#pragma once

#include "core/frame.h"

namespace grainfield::tracking {

/// Squared Euclidean distance of every pixel to the nearest pixel where mask ≤ 0.5, 0 there; pixels
/// outside the image count as part of the mask. Exact (Felzenszwalb & Huttenlocher 2012,
/// `felzenszwalb2012`), O(pixels). A mask without any zero gives (width + height)² everywhere.
Image squared_distance_transform(const Image& mask);

/// What the shape of the thresholded image says about discs of one size in it.
struct CoarseSize {
    double radius = 0;    ///< most frequent radius of the inscribed discs [px]; 0: none found
    double coverage = 0;  ///< share of the mask that discs of about that radius explain, 0–1
    int discs = 0;        ///< inscribed discs within 15 % of that radius
};

/// Local maxima of the distance transform are centres of inscribed discs. Spheres give discs of one
/// radius that cover most of the mask; the gaps between spheres do not, which tells the polarity.
CoarseSize coarse_size(const Image& mask);

}  // namespace grainfield::tracking
