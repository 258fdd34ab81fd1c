#pragma once

#include <string>

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

/// |Q4| from which a particle counts as solid, unless options say otherwise (`castillo2019`) [-].
inline constexpr double solid_order = 0.7;

/// Symmetries k of Q_k that can be asked for.
inline constexpr int least_symmetry = 1;
inline constexpr int most_symmetry = 24;

struct BondOrderOptions {
    NeighbourRule rule = NeighbourRule::near_four;
    int symmetry = 4;     ///< k of Q_k [-]: 4 square, 6 hexagonal
    double factor = 1.2;  ///< of near_four and near_delaunay [r̄4]
    double cutoff = 1.2;  ///< of fixed_cutoff [a]
    double edge = 0.3;    ///< of voronoi_edge [perimeter/4]
};

OptionTable describe(BondOrderOptions& options);

/// The measurement of Q_k that `what` says: "q4_mean".
std::string order_name(int symmetry, const std::string& what);
/// "|Q₄|"
std::string order_symbol(int symmetry);

/// Whether the rule needs the triangulation.
bool needs_triangulation(NeighbourRule rule);

}  // namespace grainfield::analysis
