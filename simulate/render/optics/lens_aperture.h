#pragma once

#include <vector>

#include "core/vec2.h"
#include "simulate/render/optics/optics.h"
#include "simulate/render/projection.h"

namespace grainfield::simulate {

/// Points that stand for a round lens of half angle α: the slopes u_j of their rays through the
/// middle of the frame, |u_j| ≤ tan α. Twelve of equal share, on a spiral of golden angle
/// (`vogel1979`): u_j = tan α sqrt((j + 1/2)/12). One point, the middle, if α = 0.
std::vector<Vec2> lens_points(double aperture);

/// The spheres as a pinhole in the middle of the lens would have to see them, to form the image
/// that the point at slope u forms of the true ones. What is in focus, at mid height z_0, stays:
///
///   (X, Y) → (X, Y) + u (z_0 − z)
///
/// Exact for centres; the outline of a sphere is taken as that of one seen straight (relative
/// error of its radius: |u|²/2).
SphereScene seen_through(const SphereScene& scene, Vec2 point, const View& view);

}  // namespace grainfield::simulate
