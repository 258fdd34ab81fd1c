#pragma once

#include <algorithm>

#include "tracking/model/profile_shape.h"
#include "tracking/model/tanh_edge.h"

namespace grainfield::tracking {

/// The image of one sphere: a disc of a size, with an edge of a width and a shape.
struct DiscProfile {
    double diameter = 0;                     ///< D [px]
    double edge_width = 0;                   ///< w [px]
    const ProfileShape* shape = &kTanhEdge;  ///< P(r; D, w)

    double radius() const { return diameter / 2; }
    /// P(r), darkness in units of the contrast.
    double darkness(double r) const { return shape->darkness(r, diameter, edge_width); }
    /// −dP/dr [1/px].
    double slope(double r) const { return shape->slope(r, diameter, edge_width); }
    /// `scale` times ∂P/∂D and ∂P/∂w [1/px].
    SizeDerivatives size_derivatives(double r, double scale = 1) const {
        return shape->size_derivatives(r, diameter, edge_width, scale);
    }
    /// Beyond this distance from the centre P < 1e-3 and counts as zero [px].
    double reach() const { return radius() + shape->reach_in_widths() * edge_width; }
    /// From core_radius() to here a disc has an edge, which tells its position [px].
    double edge_reach() const { return radius() + shape->edge_in_widths() * edge_width; }
    double core_radius() const { return std::max(0.0, diameter - edge_reach()); }

    /// Σ (∂P/∂x)² of an isolated disc: with noise σ its position is known to σ over the root of it
    /// per axis [px] (Cramér–Rao).
    double information() const { return shape->information(diameter, edge_width); }
};

}  // namespace grainfield::tracking
