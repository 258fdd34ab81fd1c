#pragma once

#include <array>
#include <vector>

#include "tracking/synthesis/synthesis_fit.h"

namespace grainfield::tracking {

/// Standard errors of one sphere [a], and the RMS of image − rendering about it [contrast].
struct SphereError {
    double x = 0, y = 0, z = 0;
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
std::vector<SphereError> sphere_errors(SynthesisFit& fit, const SynthesisLimits& limits,
                                       int threads);

constexpr int kErrorSamples = 32;

/// κ of an image.
double correlated_pixels(const Image& residual);

/// The solution of A x = b by conjugate gradients, preconditioned with the own blocks.
std::vector<std::array<double, 3>> joint_solution(const SynthesisFit::Information& a,
                                                  const std::vector<std::array<double, 3>>& b,
                                                  int threads);

}  // namespace grainfield::tracking
