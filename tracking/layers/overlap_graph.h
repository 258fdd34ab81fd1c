#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec2.h"
#include "tracking/layers/sphere_cell.h"

namespace grainfield::tracking {

/// Two spheres that seem to overlap in projection. If they do, they lie at different heights.
struct OverlapPair {
    std::uint32_t first = 0, second = 0;  ///< indices, first < second
    double rise = 0;                      ///< least |z_first − z_second|; 0: none is sure [a]
    double sure_rise = 0;  ///< the same, granting the larger errors allowed to labels; 0: none [a]
    double distance = 1;   ///< in projection [a]
    double distance_error = 0;  ///< its standard error, that by parallax included [a]
};

struct OverlapOptions {
    double significance = 3;        ///< errors granted before a sphere may be rejected [σ]
    double label_significance = 4;  ///< errors granted before a layer is named [σ]
};

/// Logarithm of the odds that two spheres `distance` apart in projection lie on opposite sides of
/// the mid-plane of the cell, to their lying on the same side.
///
///     ln (ε + ⟨P_opposite⟩) / (ε + ⟨P_alike⟩),   P = P(|z_i − z_j| ≥ √(1 − d²))
///
/// Averages run over d with its standard error. Heights are taken as uniform within either half of
/// 0 … H: P_alike = (1 − 2δ/H)² up to δ = H/2 and 0 beyond, P_opposite = 1 − 2δ²/H² up to H/2 and
/// 2(1 − δ/H)² from there to H. ε = 1e−3 is the share of positions that are wrong altogether, so
/// that no pair says more than 1000 to 1. Not negative. All lengths in a.
double opposite_log_odds(double distance, double error, double slack);

/// Which spheres overlap in projection, and what difference of height each overlap asks for.
///
///     |z_i − z_j| ≥ δ_ij = sqrt(a² − (d_ij + n σ_ij + p_ij)²),   0 ≤ z ≤ H
///
/// d_ij distance in projection, σ_ij its standard error (the two position errors along the line of
/// centres), n the significance granted, p_ij the parallax of a camera that is not telecentric.
/// Pairs at or beyond contact (d ≥ (1 − 1e−6) a) are left out; those that may be there within their
/// error (d + nσ + p) ask for nothing. Equal spheres.
class OverlapGraph {
 public:
    /// One end of a pair.
    struct Link {
        std::uint32_t sphere;  ///< at the other end
        std::uint32_t pair;
    };

    /// `errors` is empty (positions exact) or has one standard error per axis and sphere [px]; a
    /// sphere with an error that is not finite takes part in no pair. By a cell grid, O(N) at
    /// bounded density. Throws OptionError if a ≤ 0, L_z < a or a significance is negative,
    /// InputError if the columns differ in length or a position is not finite.
    OverlapGraph(const SphereCell& cell, const std::vector<Vec2>& positions,
                 const std::vector<Vec2>& errors, const OverlapOptions& options = {});

    /// From pairs; each (first, second) at most once.
    OverlapGraph(double slack, std::size_t spheres, std::vector<OverlapPair> pairs);

    std::size_t size() const { return first_link_.size() - 1; }
    double slack() const { return slack_; }  ///< H [a]
    const std::vector<OverlapPair>& pairs() const { return pairs_; }
    std::span<const Link> links(std::uint32_t sphere) const {
        return std::span(links_).subspan(first_link_[sphere],
                                         first_link_[sphere + 1] - first_link_[sphere]);
    }

 private:
    void link_pairs(std::size_t spheres);

    double slack_ = 0;
    std::vector<OverlapPair> pairs_;
    std::vector<std::uint32_t> first_link_;
    std::vector<Link> links_;
};

}  // namespace grainfield::tracking
