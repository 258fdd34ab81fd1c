#pragma once

#include <vector>

#include "core/vec2.h"
#include "tracking/model/disc_profile.h"

namespace grainfield::tracking {

/// The joint Cramér–Rao bound of positions, per axis [px]: no unbiased tracker that has to find all
/// positions from an image of these discs with white noise can have a smaller standard error,
///
///   b_x = σ sqrt((A⁻¹)_xx),   A_ij = Σ_pixels J_i J_jᵀ      (joint_covariance).
///
/// `noise` σ [contrast]. NaN for discs that the image says nothing about: all but hidden ones, and
/// those whose centre lies beyond DiscProfile::reach outside the frame. The bound is that of the
/// tracker's image model; of a camera with another edge it is right as far as D and w describe that
/// edge. Cost of joint_covariance. Independent of the number of threads.
std::vector<Vec2> position_bounds(const std::vector<Vec2>& positions, const DiscProfile& disc,
                                  int width, int height, double noise, int threads);

}  // namespace grainfield::tracking
