#pragma once

#include <vector>

#include "core/vec2.h"
#include "tracking/camera/camera.h"

namespace grainfield::tracking {

/// What of the squared residual of each disc comes of its size [contrast²]: a tilted camera sees
/// equal spheres larger here and smaller there, and the image model has one diameter.
///
/// With s, the size of a corrected pixel in the picture, the residual has a term c (s − s₀)². It is
/// fitted to the medians of r² in ten groups of discs of like s, of discs alone: none other is
/// within 1.1 times its apparent diameter. One that is too large, or out of focus, all round is not
/// displaced by it, so that it is no part of the error of its position. Where discs overlap on one
/// side it is: zero for them. Zero for all where fewer than 100 are alone, or r² does not grow to
/// both sides of an s₀ within the frame.
///
/// `position`: in the picture [px]; `residual`: RMS at the edge of each disc [contrast];
/// `diameter`: D [px]; 0: not known, then nobody is alone.
std::vector<double> size_misfit(const CameraMap& map, const std::vector<Vec2>& position,
                                const std::vector<double>& residual, double diameter = 0);

}  // namespace grainfield::tracking
