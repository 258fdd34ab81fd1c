#pragma once

#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/image_model.h"

namespace grainfield::tracking {

/// RMS noise of one pixel on the edges of the spheres [contrast]: what the Cramér–Rao bound of
/// positions is made of.
///
///   σ² = (σ²_bright + σ²_dark)/2 / (B − I_dark)²
///
/// the variance halfway up an edge of a camera whose variance is linear in the light (shot and read
/// noise). σ_bright and σ_dark come from second differences along the rows of pixels at least 4.5 w
/// from all edges (3.5 or 2.5 w where these are too few: there the curvature of an edge adds up to
/// 2 % of the contrast), between the true spheres and in their cores, so that neither shading nor
/// the positions found enter. Single outliers (hot pixels) beyond six robust standard deviations
/// are left out. Where light or dark pixels are too few, or the background is saturated (no noise
/// at all), the other of the two stands for both. 0 if there is neither. O(pixels).
double edge_noise(const Image& counts, const ImageModel& model, const std::vector<Vec2>& truth);

}  // namespace grainfield::tracking
