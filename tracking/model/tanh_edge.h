#pragma once

#include <cmath>
#include <numbers>

#include "tracking/model/profile_shape.h"

namespace grainfield::tracking {

/// The edge of an opaque sphere out of focus (`shattuck_chitrack`):
///
///   P(r) = [1 − tanh((r − D/2)/w)] / 2 = 1 / (1 + exp(2 (r − D/2)/w))
///
/// 76 % of the change lies within ±w of the edge. Kernels compute it in closed form.
class TanhEdge final : public ProfileShape {
 public:
    constexpr TanhEdge() = default;

    std::string_view name() const override { return "tanh"; }
    double darkness(double r, double diameter, double edge_width) const override {
        return 1 / (1 + std::exp(2 * (r - diameter / 2) / edge_width));
    }
    /// sech²((r − D/2)/w) / (2w).
    double slope(double r, double diameter, double edge_width) const override {
        const double p = darkness(r, diameter, edge_width);
        return 2 / edge_width * p * (1 - p);
    }
    SizeDerivatives size_derivatives(double r, double diameter, double edge_width,
                                     double scale) const override {
        const double s = slope(r, diameter, edge_width);
        return {scale * s / 2, scale * s * (r - diameter / 2) / edge_width};
    }
    /// π D/(6 w).
    double information(double diameter, double edge_width) const override {
        return std::numbers::pi * diameter / (6 * edge_width);
    }
    double reach_in_widths() const override { return kReachInWidths; }
    /// ∫_u^∞ sech⁴ / ∫_0^∞ sech⁴ = 0.03 % for u = 2.5; there P changes by less than 1.3 % of the
    /// contrast where a disc moves by w.
    double edge_in_widths() const override { return 2.5; }

    static constexpr double kReachInWidths = 3.5;
};

inline constinit const TanhEdge kTanhEdge;

}  // namespace grainfield::tracking
