#pragma once

#include <string_view>

namespace grainfield::tracking {

/// How a disc changes with its size: ∂P/∂D and ∂P/∂w [1/px].
struct SizeDerivatives {
    double by_diameter = 0;
    double by_edge_width = 0;
};

/// The radial profile of one disc, P(r; D, w): darkness in units of the contrast at the distance r
/// from the centre, D the apparent diameter and w the edge width [px].
///
/// P is about 1 in the core, 1/2 near r = D/2, and falls below 1e-3 within reach_in_widths() w of
/// the edge. Objects of this class are constants that live as long as the program; discs point to
/// them. A new shape states darkness(); the other functions have numerical defaults, accurate to
/// 1e-6 for shapes that are smooth on the scale w/1000. Kernels read shapes other than TanhEdge
/// from a table (model/kernel_profile.h). Thread-safe.
class ProfileShape {
 public:
    ProfileShape(const ProfileShape&) = delete;
    ProfileShape& operator=(const ProfileShape&) = delete;
    virtual ~ProfileShape() = default;

    /// As it is called in options and reports.
    virtual std::string_view name() const = 0;

    virtual double darkness(double r, double diameter, double edge_width) const = 0;

    /// −∂P/∂r [1/px]. Default: central difference.
    virtual double slope(double r, double diameter, double edge_width) const;

    /// `scale` times the derivatives. Default: central differences.
    virtual SizeDerivatives size_derivatives(double r, double diameter, double edge_width,
                                             double scale) const;

    /// Σ (∂P/∂x)² of an isolated disc, π ∫ (∂P/∂r)² r dr [-]. Default: trapezoidal sum.
    virtual double information(double diameter, double edge_width) const;

    /// Beyond this distance from the edge P < 1e-3 and counts as zero [w].
    virtual double reach_in_widths() const { return 3.5; }

    /// Pixels farther from the edge hold less than 0.1 % of what is known of the position [w].
    virtual double edge_in_widths() const { return 2.5; }

 protected:
    constexpr ProfileShape() = default;
};

}  // namespace grainfield::tracking
