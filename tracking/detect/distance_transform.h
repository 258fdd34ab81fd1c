#pragma once

#include "core/frame.h"

namespace grainfield::tracking {

/// Squared Euclidean distance of every pixel to the nearest pixel where mask ≤ 0.5, 0 there; pixels
/// outside the image count as part of the mask. Exact (Felzenszwalb & Huttenlocher 2012,
/// `felzenszwalb2012`), O(pixels). A mask without any zero gives (width + height)² everywhere.
Image squared_distance_transform(const Image& mask);

}  // namespace grainfield::tracking
