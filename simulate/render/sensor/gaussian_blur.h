#pragma once

#include "core/frame.h"

namespace grainfield::simulate {

/// The pixels on one side that gaussian_blur looks at: 4 σ, rounded up.
int blur_reach(double sigma);

/// Convolves with a Gaussian sampled at the pixels and cut at 4 σ, normalised, separably. Only
/// pixels at least blur_reach from the border are right; the result is smaller by blur_reach on
/// every side. Its moments are those of the continuous Gaussian to 1e-4 for σ ≥ 1 px.
/// O(pixels · σ); same bits for any number of threads. σ = 0 gives the image back.
Image gaussian_blur(const Image& image, double sigma, int threads);

}  // namespace grainfield::simulate
