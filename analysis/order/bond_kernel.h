#pragma once

#include <cstddef>

#include "analysis/geometry/neighbours.h"
#include "analysis/order/bond_order_options.h"

namespace grainfield::analysis {

/// Where the kernel writes, by original index of the point: arrays of a BondOrderField.
struct BondKernelOutput {
    double* q;  ///< real and imaginary part in turn
    int* neighbours;
    std::size_t* first;
    double* nearest;
    double* mean_four;
    int* neighbour;      ///< the list of all neighbours
    std::size_t listed;  ///< entries of it; the kernel appends
    int* left;           ///< points that it leaves to the general search
    std::size_t left_count;
};

/// Candidates of one point, at most: where there are more, the general search takes over.
inline constexpr std::size_t most_candidates = 64;

/// Bond order of the points in cells `from` … `to` − 1 by the rules near_four, four_nearest and
/// fixed_cutoff: the points of the 3 × 3 cells around each cell, several at a time. `neighbour` has
/// room for most_candidates more entries a point of these cells, `left` for all of them. Points
/// that this does not decide (a neighbour may lie farther off, the box is wrapped here, equal
/// distances, fewer than four others) are appended to `left`, and nothing is written for them.
///
/// Neighbours are the same for any instruction set, Q up to rounding.
void bond_orders(const CellList::View& cells, const BondOrderOptions& options, std::size_t from,
                 std::size_t to, BondKernelOutput& output);

}  // namespace grainfield::analysis
