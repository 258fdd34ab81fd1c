#include "analysis/order/bond_order_options.h"

namespace grainfield::analysis {

OptionTable describe(BondOrderOptions& options) {
    OptionTable table("q4");
    table.choice("neighbours", options.rule,
                 {{"near-four", NeighbourRule::near_four},
                  {"near-delaunay", NeighbourRule::near_delaunay},
                  {"four-nearest", NeighbourRule::four_nearest},
                  {"delaunay", NeighbourRule::delaunay},
                  {"fixed-cutoff", NeighbourRule::fixed_cutoff},
                  {"voronoi-edge", NeighbourRule::voronoi_edge},
                  {"edge-weighted", NeighbourRule::edge_weighted}},
                 "which particles count as neighbours");
    table.integer("symmetry", options.symmetry, "-", {1, 24}, "k of the k-fold order");
    table.number("factor", options.factor, "-", {1, 3},
                 "largest distance of a neighbour over the mean of the four nearest");
    table.number("cutoff", options.cutoff, "a", {0.01, 100}, "radius of fixed-cutoff");
    table.number("edge", options.edge, "-", {0, 4},
                 "least length of the edge to a neighbour of voronoi-edge over a quarter of the "
                 "perimeter of the Voronoi cell");
    return table;
}

bool needs_triangulation(NeighbourRule rule) {
    return rule == NeighbourRule::delaunay || rule == NeighbourRule::near_delaunay ||
           rule == NeighbourRule::voronoi_edge || rule == NeighbourRule::edge_weighted;
}

}  // namespace grainfield::analysis
