#pragma once

#include <vector>

#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

/// RMS of I − M at the edge of each disc [contrast], steadied where noise makes it uncertain.
///
/// An edge of n pixels has white noise σ beside a mean square m² of misfit in it, so that its mean
/// square V is known to s² = (2 σ⁴ + 4 σ² m²)/n. Edges of one frame are taken to have misfits that
/// differ by a quarter of their mean m². V is drawn to that mean by the share s²/(s² + (m²/4)²):
/// hardly at all in frames of little noise, nearly all the way where the image model is right.
/// Where an edge has no pixel it is what is left within reach, or σ. O(discs).
std::vector<double> edge_residuals(const JointFit::Residuals& left, double noise);

}  // namespace grainfield::tracking
