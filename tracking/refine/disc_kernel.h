#pragma once

#include "core/frame.h"
#include "core/vec2.h"
#include "tracking/disc_profile.h"

namespace grainfield::tracking {

/// Small pure kernels of the product-of-transmissions model on the pixels around one disc.
///
///   M(x) = 1 − T(x),   T(x) = Π_j t_j(x),   t_j = 1 − P_j
///
/// All work in single precision on the rows of the window |x − centre| ≤ reach and sum in double.
/// t is kept within [1e-3, 1], so that a disc can be divided out of T again.

/// The normal equations of one disc's position, all others fixed:
///   J = ∂M/∂(x, y) = T · (2/w) P · (x − centre)/r,  A = Σ J Jᵀ,  b = Σ J (I − M).
struct NormalEquations {
    double xx = 0, xy = 0, yy = 0;  ///< A [1/px²]
    double bx = 0, by = 0;          ///< b [1/px]
    double misfit = 0;              ///< Σ (I − M)² over the window
    int pixels = 0;                 ///< pixels in the window

    double determinant() const { return xx * yy - xy * xy; }
};

NormalEquations normal_equations(const Image& darkness, const Image& transmission, Vec2 centre,
                                 const DiscProfile& disc);

/// T ← T · t_centre.
void place_disc(Image& transmission, Vec2 centre, const DiscProfile& disc);

/// T ← T / t_centre.
void lift_disc(Image& transmission, Vec2 centre, const DiscProfile& disc);

/// T ← T · t_to / t_from, and the change of Σ (I − M)² that this brings.
double move_disc(const Image& darkness, Image& transmission, Vec2 from, Vec2 to,
                 const DiscProfile& disc);

/// By how much Σ (I − M)² would grow if the disc were lifted: what it explains [contrast² px].
double explained_misfit(const Image& darkness, const Image& transmission, Vec2 centre,
                        const DiscProfile& disc);

}  // namespace grainfield::tracking
