#pragma once

#include <vector>

#include "tracking/synthesis/synthesis_fit.h"

namespace grainfield::tracking {

/// Standard errors of one sphere [a], and the RMS of image − rendering about it [contrast].
struct SphereError {
    double x = 0, y = 0, z = 0;
    double residual = 0;
};

/// From the information matrix A of a sphere and those within 1.35 a of it, all others fixed:
/// C = A⁻¹ σ² κ. σ: RMS residual within 0.6 a, at least the median over all spheres; κ: the sum of
/// the residual's spatial correlation over 7 × 7 lags, 1 for white noise: a misfit of the model is
/// not independent from pixel to pixel.
std::vector<SphereError> sphere_errors(SynthesisFit& fit, const SynthesisLimits& limits,
                                       int threads);

/// κ of an image.
double correlated_pixels(const Image& residual);

}  // namespace grainfield::tracking
