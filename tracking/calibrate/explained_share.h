#pragma once

#include <cstddef>

#include "core/frame.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// How much of the variance of an image discs explain, and what that is worth.
struct ExplainedShare {
    double all = 0;     ///< 1 − misfit/variance
    double signal = 0;  ///< the same after the white noise was taken from both
    /// What the image tells apart, per number that was fitted: N/p. Discs of 2 and more are
    /// resolved; below 1 there are more numbers than the image could contradict.
    double support = 0;
    /// 1 − (1 − signal) N/(N − p): the share that is left when every fitted number has paid for
    /// itself; 0 where p reaches N.
    double charged = 0;
};

/// Pixels that one independent value of a blurred image takes, at least one. A point spread whose
/// edge is a tanh of width w has the variance π² w²/12 along an axis. A Gaussian one of that
/// variance s² lets 1/(4π s²) values a pixel pass (the integral of its squared transfer function):
/// π³ w²/3 pixels a value.
double resolution_cell(double edge_width);

/// Of a fit of `spheres` discs, two coordinates each, that leaves `residual_rms` of the darkness
/// image; `noise`: RMS from pixel to pixel, likewise [contrast]. N is the number of visible pixels
/// over the resolution cell of the fitted edge width: many small, soft discs can imitate the image
/// of anything, but then they have as many coordinates as their own blur lets through.
ExplainedShare explained_share(const Image& darkness, const VisiblePixels& visible,
                               double residual_rms, double noise, const DiscProfile& disc,
                               std::size_t spheres);

}  // namespace grainfield::tracking
