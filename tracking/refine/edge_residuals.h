#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "tracking/refine/joint_fit.h"

namespace grainfield::tracking {

/// Whether the edge of a disc meets another one.
enum class EdgeKind : std::uint8_t { alone, meeting };
inline constexpr std::size_t kEdgeKinds = 2;

/// Of all discs of a frame of that size. O(discs).
std::vector<EdgeKind> edge_kinds(const std::vector<Vec2>& discs, const DiscProfile& disc, int width,
                                 int height);

/// RMS of I − M at the edge of each disc [contrast], steadied where noise makes it uncertain.
///
/// V is the mean square at one edge, of n pixels, and m̄² the mean of V − σ² over the edges of its
/// kind, to which 5 of the mean of all edges are added. White noise σ makes V uncertain by s² = (2
/// σ⁴ + 4 σ² m̄²)/n. Misfits are taken to differ from edge to edge by a quarter of m̄². V is drawn to
/// σ² + m̄² by the share s²/(s² + (m̄²/4)²): hardly at all in frames of little noise, nearly all the
/// way where the image model is right. Edges of more than ten times the median V are no part of m̄².
/// Where an edge has no pixel it is what is left within reach, or σ. O(discs).
std::vector<double> edge_residuals(const JointFit::Residuals& left,
                                   const std::vector<EdgeKind>& kinds, double noise);

/// What the camera's noise σ and the misfit of the model make of an error of one per unit noise
/// [contrast]:
///
///     √(σ² + κ m²),   m² = V − σ² − harmless, 0 at least
///
/// V is the square of `edge_residual`, κ the correlation of the misfit (misfit_correlation.h).
/// `harmless`: misfit that displaces nothing [contrast²].
double effective_noise(double noise, double correlation, double edge_residual, double harmless = 0);

}  // namespace grainfield::tracking
