#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/vec2.h"
#include "tracking/layers/sphere_cell.h"

namespace grainfield::tracking {

/// Two spheres that overlap in projection and therefore lie at different heights.
struct OverlapPair {
    std::uint32_t first = 0, second = 0;  ///< indices, first < second
    double rise = 0;                      ///< least |z_first − z_second| [a]
    double sure_rise = 0;  ///< the same, granting the larger errors allowed to labels; 0: none [a]
};

struct OverlapOptions {
    double significance = 3;        ///< errors granted before a sphere may be rejected [σ]
    double label_significance = 4;  ///< errors granted before a layer is named [σ]
};

/// Which spheres overlap in projection, and what difference of height each overlap asks for.
///
///     |z_i − z_j| ≥ δ_ij = sqrt(a² − (d_ij + n σ_ij + p_ij)²),   0 ≤ z ≤ H
///
/// d_ij distance in projection, σ_ij its standard error (the two position errors along the line of
/// centres), n the significance granted, p_ij the parallax of a camera that is not telecentric.
/// Pairs at or beyond contact (d + nσ + p ≥ (1 − 1e−6) a) ask for nothing and are left out. Equal
/// spheres.
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
