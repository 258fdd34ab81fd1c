#pragma once

#include <complex>
#include <cstddef>
#include <vector>

#include "analysis/pattern.h"
#include "core/option_table.h"

namespace grainfield::analysis {

/// Which particles count as neighbours of a particle; r̄4 is the mean distance of its four nearest.
enum class NeighbourRule {
    near_four,      ///< all with r < factor · r̄4 (cell list)
    near_delaunay,  ///< Delaunay neighbours with r < factor · r̄4
    four_nearest,   ///< the four nearest
    delaunay,       ///< all Delaunay neighbours; blind to a square lattice (docs/analysis.md)
    fixed_cutoff,   ///< all with r < cutoff
    voronoi_edge,   ///< Delaunay neighbours with an edge longer than `edge` · perimeter/4
    edge_weighted   ///< Delaunay neighbours, each with the share of its edge in the perimeter
};

struct BondOrderOptions {
    NeighbourRule rule = NeighbourRule::near_four;
    int symmetry = 4;     ///< k of Q_k [-]: 4 square, 6 hexagonal
    double factor = 1.2;  ///< of near_four and near_delaunay [r̄4]
    double cutoff = 1.2;  ///< of fixed_cutoff [a]
    double edge = 0.3;    ///< of voronoi_edge [perimeter/4]
};

OptionTable describe(BondOrderOptions& options);

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

/// Whether the rule needs the triangulation.
bool needs_triangulation(NeighbourRule rule);

}  // namespace grainfield::analysis
