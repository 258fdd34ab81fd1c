#pragma once

#include <cstdint>
#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/disc_profile.h"
#include "tracking/model/visible_pixels.h"

namespace grainfield::tracking {

/// Size and edge of the spheres from the parts of their edges that nothing else touches.
struct EdgeFit {
    DiscProfile disc;
    double amplitude = 1;     ///< core less background [contrast]; 1 if the levels were right
    double offset = 0;        ///< darkness of the clear background [contrast]; 0 if it was right
    double rms = 0;           ///< of the residual over the pixels used [contrast]
    std::int64_t pixels = 0;  ///< pixels used; 0: no exposed edge, `disc` is the one that came in
    bool converged = false;
};

/// Mean darkness of the exposed pixels at one distance from their centre.
struct RadialBin {
    double r = 0;         ///< mean [px]
    double darkness = 0;  ///< mean [contrast]
    double squares = 0;   ///< Σ darkness²
    double count = 0;     ///< pixels
};

/// The radial profile over pixels that only one disc reaches, in bins of 0.02 px; empty bins are
/// left out. Other discs reach out to where their P falls below 0.01 (u = 2.3).
std::vector<RadialBin> exposed_profile(const Image& darkness, const std::vector<Vec2>& positions,
                                       const DiscProfile& disc, const VisiblePixels& visible = {});

/// A first value of w [px]: pixels with darkness between 1/4 and 3/4 make a band of width 2 w
/// artanh(1/2) along all edges. The length of the edges is π/4 times the number of neighbours in
/// rows and columns between which the darkness crosses 1/2 (Cauchy–Crofton). Too large where the
/// noise exceeds 0.1 of the contrast or edges of neighbours merge; 0 without edges. O(pixels).
double rough_edge_width(const Image& darkness, const VisiblePixels& visible = {});

/// Least squares of o + A · P(r; D, w) over the pixels within reach of exactly one disc and where
/// every other disc has P < 0.01. Fitting D inside dense patches would bias it (+0.1 … 2 px),
/// because the model must explain darkness that belongs to hidden neighbours; exposed edges do not.
/// Gauss–Newton on (D, w, A, o), positions fixed. O(discs).
EdgeFit fit_exposed_edges(const Image& darkness, const std::vector<Vec2>& positions,
                          const DiscProfile& start, const VisiblePixels& visible = {});

}  // namespace grainfield::tracking
