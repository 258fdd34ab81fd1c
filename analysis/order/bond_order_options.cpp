#include "analysis/order/bond_order_options.h"

#include <array>
#include <cstddef>

#include <fmt/format.h>

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
    table.integer("symmetry", options.symmetry, "-", {least_symmetry, most_symmetry},
                  "k of the k-fold order");
    table.number("factor", options.factor, "-", {1, 3},
                 "largest distance of a neighbour over the mean of the four nearest");
    table.number("cutoff", options.cutoff, "a", {0.01, 100}, "radius of fixed-cutoff");
    table.number("edge", options.edge, "-", {0, 4},
                 "least length of the edge to a neighbour of voronoi-edge over a quarter of the "
                 "perimeter of the Voronoi cell");
    return table;
}

std::string order_name(int symmetry, const std::string& what) {
    return fmt::format("q{}_{}", symmetry, what);
}

std::string order_symbol(int symmetry) {
    static constexpr std::array<const char*, 10> lowered{"₀", "₁", "₂", "₃", "₄",
                                                         "₅", "₆", "₇", "₈", "₉"};
    std::string symbol = "|Q";
    for (const char c : std::to_string(symmetry))
        symbol += lowered.at(static_cast<std::size_t>(c - '0'));
    return symbol + "|";
}

bool needs_triangulation(NeighbourRule rule) {
    return rule == NeighbourRule::delaunay || rule == NeighbourRule::near_delaunay ||
           rule == NeighbourRule::voronoi_edge || rule == NeighbourRule::edge_weighted;
}

}  // namespace grainfield::analysis
