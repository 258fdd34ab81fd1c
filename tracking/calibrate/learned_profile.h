#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/disc_model.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// What the image of a sphere has that a tanh edge has not.
struct LearnedProfile {
    RadialCorrection correction;   ///< zero where too few pixels show it, or nothing is significant
    double veil = 0;               ///< o, darkness of the clear background [contrast]
    std::int64_t pixels = 0;       ///< looked at that one disc reaches
    double fewest = 0;             ///< of them about one value of C at the edge
    double rms = 0, rms_left = 0;  ///< of these pixels, before and without what was learned
    double error = 0;              ///< largest standard error of such a value [contrast]

    static constexpr double kFewest = 200;  ///< wanted
    bool is_sampled() const { return fewest >= kFewest; }
};

/// Learns C(r) from the residual image − model of a frame whose spheres are at rest, on the pixels
/// near one sphere at most: of all others P < 0.01. With transmissions t_j = 1 − P_j of the tanh
/// discs, to first order in C,
///
///   residual(x) = o Π_j t_j + Σ_j C(r_j) Π_{i≠j} t_i,   C(r) = Σ_k C_k h_k(r),
///
/// least squares over C_k and o; h_k are hat functions w/4 apart (at most 400). C at the reach of
/// the disc is zero: what is left there, o, belongs to the background, and C is in units of the
/// contrast without it (divided by 1 − o). Tails of several discs in one pixel are thus told apart.
/// Each value is multiplied by max(0, 1 − (2 σ_k/C_k)²), σ_k its standard error from the scatter
/// about the fit: noise teaches nothing. D and w stay those of the tanh fit. From about 200,000
/// pixels of the frame. O(pixels looked at).
LearnedProfile learn_profile(const Image& residual, const std::vector<Vec2>& positions,
                             const DiscProfile& disc, const VisiblePixels& visible = {});

}  // namespace grainfield::tracking
