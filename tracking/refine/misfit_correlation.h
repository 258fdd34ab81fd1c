#pragma once

#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

/// κ: the variance of a position that the misfit of the image model makes, over what it would make
/// if it were independent from pixel to pixel and equally large everywhere. `noise`: σ, RMS of the
/// camera [contrast].
///
/// Least squares moves a disc by A⁻¹ s, with the score s = Σ_p J_p r_p over its pixels, the
/// derivative J = ∂P/∂x and the residual r = I − M. The covariance of the score is
/// Σ_pq J_p J_q C(p − q). With the autocorrelations C of the residual and a(Δ) = Σ_p J_p J_{p+Δ} of
/// an isolated disc, the mean of both directions,
///
///   ρ = Σ_Δ a(Δ) C(Δ) / (a(0) C(0)),   κ₀ = h (1 + (ρ − 1)/(1 − x)).
///
/// These are of the whole residual, of variance C(0); camera noise of the variance σ² is white, so
/// that the misfit has
///
///   κ = (κ₀ C(0) − σ²)/(C(0) − σ²).
///
/// x = 2 n Σ_Δ a(Δ)² / a(0)² for n discs a pixel: the share of ρ − 1 that the fit of the positions
/// has taken from the residual, to first order, at most 0.7. h: misfit_at_edges(). κ is 1 where
/// less than a twentieth of C(0) is misfit, and at least 1: less is chance. C is summed over rows
/// spread evenly over the frame, at lags up to D. 1 for a frame of fewer than 4 D rows or columns.
/// Independent of the number of threads. Some milliseconds a frame.
double misfit_correlation(const JointFit& fit, double noise);

/// h: the mean of r² weighted with (∂P/∂r)², where a pixel tells a position, over its mean within
/// reach of the discs. Of 400 to 800 discs spread over the list, or of all.
double misfit_at_edges(const JointFit& fit);

}  // namespace grainfield::tracking
