#pragma once

#include "tracking/refine/stencil_view.h"

namespace grainfield::tracking {

/// Kernels that read the t of a disc where it is kept, computed or from a template.

/// Asks for a disc's pixels ahead of their use.
void fetch(const ConstStencilView& view);

/// T ← T / t. Returns the change of Σ (I − M)².
double lift(const StencilView& view);

/// By how much Σ (I − M)² would grow if the disc were lifted [contrast² px].
double explained(const ConstStencilView& view);

/// Summed over the edge. `centre` is where t was kept.
NormalEquations linearise(const ConstStencilView& view, Vec2 centre);

/// Σ (I − M)² over the visible pixels within reach, and their number; and with the weights
/// w = (T (1 − t))². For tanh edges they are as |∂T/∂r|² of the disc, for others nearly.
struct LocalMisfit {
    double sum = 0;  ///< [contrast²]
    double pixels = 0;
    double at_edge = 0;  ///< Σ w (I − M)² [contrast²]
    double edge = 0;     ///< Σ w
    double edge2 = 0;    ///< Σ w²
};
LocalMisfit local_misfit(const ConstStencilView& view, Vec2 centre);

/// Each centre is where the t of that disc was kept.
CrossBlock coupling(const ConstStencilView& a, Vec2 centre_a, const ConstStencilView& b,
                    Vec2 centre_b);

}  // namespace grainfield::tracking
