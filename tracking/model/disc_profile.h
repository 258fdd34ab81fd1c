#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// The image of one opaque sphere: a disc with a soft edge (Shattuck, `shattuck_chitrack`).
///
///   P(r) = [1 − tanh((r − D/2)/w)] / 2 = 1 / (1 + exp(2 (r − D/2)/w))
///
/// P is the darkness in units of the contrast, 1 inside and 0 outside; D the apparent diameter and
/// w the edge width, both in pixels. 76 % of the change lies within ±w of the edge.
struct DiscProfile {
    double diameter = 0;    ///< D [px]
    double edge_width = 0;  ///< w [px]

    double radius() const { return diameter / 2; }
    double darkness(double r) const { return 1 / (1 + std::exp(2 * (r - radius()) / edge_width)); }
    /// −dP/dr = sech²((r − D/2)/w) / (2w) [1/px].
    double slope(double r) const {
        const double p = darkness(r);
        return 2 / edge_width * p * (1 - p);
    }
    /// Beyond this distance from the centre P < 1e-3 and counts as zero [px].
    double reach() const { return radius() + kReachInWidths * edge_width; }

    /// Pixels farther from the edge than kEdgeInWidths w hold ∫_u^∞ sech⁴ / ∫_0^∞ sech⁴ = 0.03 % of
    /// what is known of the position, u = 2.5, and change by less than 1.3 % of the contrast where
    /// a disc moves by w; up to here from the centre [px].
    double edge_reach() const { return radius() + kEdgeInWidths * edge_width; }

    /// Σ (∂P/∂x)² of an isolated disc, π D/(6 w): with noise σ its position is known to σ over the
    /// root of it per axis [px] (Cramér–Rao).
    double information() const { return std::numbers::pi * diameter / (6 * edge_width); }

    static constexpr double kReachInWidths = 3.5;
    static constexpr double kEdgeInWidths = 2.5;
};

/// C(r), by how much the image of a sphere is darker than the tanh profile: a mirror rim, a blur of
/// another shape, less or more light from the core. Linear between the values at r = 0, spacing,
/// 2 spacing …; zero beyond the last. Learned once (calibrate/learned_profile.h), then frozen.
struct RadialCorrection {
    double spacing = 0;        ///< [px]
    std::vector<float> value;  ///< [contrast]; empty: the profile is tanh

    bool is_zero() const { return value.empty(); }
    float operator()(float r) const {
        const float place = r / static_cast<float>(spacing);
        const auto i = static_cast<std::size_t>(place);
        if (i + 1 >= value.size()) return 0;
        return value[i] + (place - static_cast<float>(i)) * (value[i + 1] - value[i]);
    }
    /// The largest of |C| [contrast].
    double largest() const {
        float most = 0;
        for (const float v : value) most = std::max(most, std::abs(v));
        return static_cast<double>(most);
    }
};

/// How the edges of several discs make one image: each disc dims what the others let pass, or the
/// lens blurs the union of opaque discs (refine/edge_meeting.h).
enum class EdgeMeeting { product, blurred_union };

}  // namespace grainfield::tracking
