#pragma once

#include <vector>

#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

/// κ: the variance of a position that the misfit of the image model makes, over what it would make
/// if it were independent from pixel to pixel. `noise`: σ, RMS of the camera [contrast]. `left`:
/// what is left about each disc.
///
/// Least squares moves a disc by A⁻¹ s, with the score s = Σ_p J_p r_p over its pixels, the
/// derivatives J = ∂P/∂(x, y) and the residual r = I − M. Scores are taken at places about the
/// discs, up to D/2 beside them per axis:
///
///   S = ⟨|s|²⟩ / Σ |J|²,   κ = (S/(1 − x) − σ²)/(⟨r²⟩ − σ²).
///
/// ⟨r²⟩ is the mean over the same windows. The fit has taken from the residual what the discs could
/// explain. With n discs a pixel, to first order, that lowers S by the share
///
///   x = 2 n Σ_Δ a(Δ)² / a(0)²,   a(Δ) = Σ_p J_p · J_{p+Δ},
///
/// at most 0.7. κ is 1 where less than a twentieth of the residual is misfit, about the discs and
/// at their edges, where fewer than 100 windows lie inside the frame without a hidden pixel, and
/// where it would be less, which is chance. Places are drawn from a fixed stream. Independent of
/// the number of threads. Some milliseconds.
double misfit_correlation(const JointFit& fit, double noise, const JointFit::Residuals& left);

}  // namespace grainfield::tracking
