#pragma once

#include <cstdint>
#include <vector>

#include "core/snapshot.h"
#include "tracking/layers/overlap_graph.h"

namespace grainfield::tracking {

/// Which spheres lie below and which above the mid-plane, up to turning a cluster upside down.
struct LayerLabels {
    std::vector<Layer> layer;             ///< unknown: not told by overlaps, left out, or doubtful
    std::vector<std::int32_t> cluster;    ///< spheres whose layers are fixed together; −1: none
    std::vector<double> lowest, highest;  ///< bounds of the centre's height, 0 … H [a]
    std::int32_t clusters = 0;
    std::int64_t contradictory = 0;  ///< spheres of rings that no heights fit
    double slack = 0;                ///< H [a]
};

/// Labels the kept spheres by what their overlaps force, and by what they make likely.
///
/// With w the height over the far plate (z for a sphere above the mid-plane, H − z below), a sphere
/// lies at H/2 ≤ w ≤ H whichever side it is on. Two overlapping spheres are
///
///     opposite if both orders on one side are impossible: u_i < l_j + δ and u_j < l_i + δ
///              (at first: δ > H/2, that is d < sqrt(1 − ((L_z − a)/2a)²) a),
///     alike    if u_i + u_j < H + δ,
///
/// and then bound each other, w_i ≥ H + δ − u_j (opposite) or w_i ≥ w_j + δ (alike, if j cannot be
/// the higher). [l, u] are the bounds so far; this is repeated until nothing changes, the largest δ
/// first. What is forced is certain if the positions are within the significance granted to
/// labels and no false sphere is among them. Where overlaps contradict each other, one sphere of
/// every ring of them that does is not where it seems: the spheres of the shortest such rings stay
/// unknown, and the rest is inferred anew without them.
///
/// What is forced falls into groups. All overlaps between two groups together may tell how one is
/// turned against the other: they are joined where the odds are 100 to 1 (opposite_log_odds,
/// join_sides). Groups are named from the largest on, but none that overlaps a named one. So two
/// spheres that are named and overlap are of one group.
///
/// A silhouette does not say which side is up. Convention: in each cluster the side with more
/// spheres is called bottom; if both have as many, that of the sphere with the lowest index.
///
/// `kept` has one value a sphere (0: left out). O(pairs log pairs).
LayerLabels label_layers(const OverlapGraph& graph, const std::vector<char>& kept);

/// Turns clusters so that most spheres keep the layer they had; `earlier` has one layer per sphere
/// (of the same sphere in an earlier frame; unknown: no say). Ties leave a cluster as it is. Throws
/// InputError if the lengths differ.
void keep_sides(LayerLabels& labels, const std::vector<Layer>& earlier);

}  // namespace grainfield::tracking
