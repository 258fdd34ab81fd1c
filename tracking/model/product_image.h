#pragma once

#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/disc_model.h"

namespace grainfield::tracking {

/// The darkness image that the product of transmissions should be fitted to at these positions:
///
///   I + (T' − T) + Π_j (1 − P_j − C_j) − T,   T = Π_j (1 − P_j),
///
/// T' the transmission of the model's overlap rule, C its radial correction. The image itself for a
/// product of uncorrected discs. O(discs); bands of rows in parallel, the same
/// bits for any number of threads.
Image product_image(const Image& darkness, const std::vector<Vec2>& positions,
                    const DiscModel& model, int threads);
/// The same into `result`, whose memory is kept if it has that size.
void product_image(const Image& darkness, const std::vector<Vec2>& positions,
                   const DiscModel& model, int threads, Image& result);

}  // namespace grainfield::tracking
