#pragma once

#include <array>
#include <vector>

#include "tracking/synthesis/synthesis_fit.h"

namespace grainfield::tracking {

/// Standard errors of one sphere [a], and the RMS of image − rendering about it [contrast].
struct SphereError {
    double x = 0, y = 0, z = 0;
    double x_by_z = 0, y_by_z = 0;  ///< of x and y, the part that goes with z: σ_xz / σ_z
    double residual = 0;
};

/// By how much all spheres together would move under noise like the residual:
///
///     C = A⁻¹ κ Jᵀ⟨r²⟩J A⁻¹
///
/// A is the joint information matrix of all spheres, J the derivatives. ⟨r²⟩: the mean square of
/// image − rendering within about 0.6 a, at least its median; κ: the sum of the residual's spatial
/// correlation over 7 × 7 lags, 1 for white noise: a misfit of the model is not independent from
/// pixel to pixel. The diagonal of C is the mean over kErrorSamples draws of the noise: its own
/// relative error is an eighth. So errors hold what spheres share, as heights that rise together.
/// What a wrong model of the light does alike everywhere is not in them. Same bits for any number
/// of threads.
std::vector<SphereError> sphere_errors(SynthesisFit& fit, int threads);

/// How many times larger errors of heights must be for the overlaps of hard spheres to be no
/// surprise, 1 or more.
///
/// No two centres are nearer than a diameter. Where the image puts them nearer, its distance d is
/// wrong by that much or more, whatever is wrong with the model of the light. Counted are pairs
/// whose d is uncertain by their heights more than by x and y, both 1.5 a or more within the frame
/// and neither doubtful (`is_doubtful`, one entry a sphere). Where gaps are wider than errors, the
/// density of true distances is even about 1. Then of (1 − d) / σ_d, over those that overlap, 68.3
/// % lie below .77 and 95.4 % below 1.70. The factor is the larger of these quantiles over those
/// numbers. If all pairs touched it would be too large by 30 % at most.
///
/// d and σ_d are those of one Gauss–Newton step without the penalty of contacts, under the noise of
/// sphere_errors. 1 where fewer than 60 pairs overlap. A diameter that is too large makes overlaps,
/// and so the factor, larger. Same bits for any number of threads.
double overlap_factor(SynthesisFit& fit, const std::vector<char>& is_doubtful, int threads);

constexpr int kErrorSamples = 32;

/// κ of an image.
double correlated_pixels(const Image& residual);

/// The solution of A x = b by conjugate gradients, preconditioned with the own blocks.
std::vector<std::array<double, 3>> joint_solution(const SynthesisFit::Information& a,
                                                  const std::vector<std::array<double, 3>>& b,
                                                  int threads);

}  // namespace grainfield::tracking
