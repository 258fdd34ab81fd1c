#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "analysis/order/bond_order_options.h"
#include "analysis/pattern.h"

namespace grainfield::analysis {

/// Bond-orientational order of one pattern, particle by particle.
struct BondOrderField {
    std::vector<std::complex<double>> q;  ///< Q_k [-]; NaN where a particle has no neighbour
    std::vector<int> neighbours;          ///< N_j
    std::vector<std::size_t> first;       ///< of the neighbours of particle j in `neighbour`
    std::vector<int> neighbour;           ///< all neighbours: N_j entries from first[j]
    std::vector<double> nearest;          ///< distance of the nearest particle [a]; NaN if none
    std::vector<double> mean_four;        ///< r̄4 [a]; NaN with fewer than four others
};

/// Bond-orientational order parameter:
///
///   Q_k^j = (1/N_j) Σ_s exp(i k θ_s),
///
/// θ_s the direction from particle j to its neighbour s, N_j their number (`nelson1979`); by the
/// rule edge_weighted Σ_s l_s exp(i k θ_s)/Σ_s l_s, l_s the edge between the Voronoi cells of j and
/// s
/// (`mickel2013`), which depends smoothly on the positions. |Q4| = 1 in a square lattice, its
/// phase / 4 is the lattice direction. Powers of (x + iy)/r, no trigonometry. Edges end at walls.
///
/// Without periodic boundaries particles at the edge have neighbours on one side only and are kept.
/// Particles that coincide are no neighbours. Cost O(N) with a cell list, O(N log N) with Delaunay.
/// Thread-safe.
BondOrderField bond_order(const Pattern& pattern, const BondOrderOptions& options);

/// |Q_k| of each particle of one snapshot, NaN where it is undefined (no neighbour, or a position
/// that is not finite). `diameter` [length unit of the snapshot].
std::vector<double> abs_q4(const Snapshot& snapshot, double diameter,
                           const BondOrderOptions& options);

}  // namespace grainfield::analysis
