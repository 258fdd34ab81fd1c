#pragma once

#include <vector>

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/model/disc_profile.h"

namespace grainfield::bench {

/// What a pixel sees where discs overlap: Σ_j P_j, max_j P_j or 1 − Π_j (1 − P_j).
enum class ImageSum { additive, maximum, product };

struct ReferenceFitOptions {
    ImageSum sum = ImageSum::product;
    double ring = tracking::TanhEdge::kReachInWidths;  ///< half-width of what a step sums [w]
    int max_sweeps = 60;
    double tolerance = 0.003;  ///< [px]
};

/// Joint least squares over all positions with the image model and the arithmetic of choice: what
/// the tracker could have been. Gauss–Seidel sweeps of 2 × 2 Gauss–Newton steps as JointFit does
/// them, a step that raises the misfit shortened, discs at rest among discs at rest skipped, but
/// plain: no vectors, no tiles, every number a `Real` (float or double, both are instantiated).
/// Finds and removes nothing. About 20 µs a disc and sweep at D = 16 px.
template <class Real>
std::vector<Vec2> reference_fit(const Image& darkness, const tracking::DiscProfile& disc,
                                const std::vector<Vec2>& start, const ReferenceFitOptions& options);

}  // namespace grainfield::bench
