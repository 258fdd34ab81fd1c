#pragma once

#include <vector>

#include "tracking/refine/stencil_view.h"

namespace grainfield::tracking {

/// Kernels that compute the t of a disc from its profile.

/// T ← T · t_centre, t kept. Returns the change of Σ (I − M)².
double place(const StencilView& view, Vec2 centre);

/// The same without the answer.
void draw(const StencilView& view, Vec2 centre);

/// T and t before a shift.
struct BeforeShift {
    Redraw redraw = Redraw::whole;
    std::vector<float> transmission;
    std::vector<HalfFloat> kept;
};

/// T ← T · t_to / t, t kept anew, in the disc's own values; the anchor must hold `to`, and a disc
/// drawn from a template is redrawn as a whole. Returns the change of Σ (I − M)².
double shift(const StencilView& view, Vec2 to, Redraw redraw, BeforeShift& before);

/// The same without the answer and the way back.
void redraw(const StencilView& view, Vec2 to, Redraw redraw);

/// Undoes the last shift.
void undo(const StencilView& view, const BeforeShift& before);

/// linearise() and coupling() (drawn_disc.h) with the derivatives computed.
NormalEquations linearise_computed(const ConstStencilView& view, Vec2 centre);
CrossBlock couple_computed(const ConstStencilView& a, Vec2 centre_a, const ConstStencilView& b,
                           Vec2 centre_b);

}  // namespace grainfield::tracking
