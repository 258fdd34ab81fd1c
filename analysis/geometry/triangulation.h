#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "analysis/geometry/neighbour_list.h"
#include "core/box.h"

namespace grainfield::analysis {

/// The Delaunay neighbours of every point: pairs whose Voronoi cells share an edge, and its length.
///
/// Exact for coordinates rounded to 2^-29 of half of the pattern's extent (`Delaunay`); cocircular
/// points give no diagonal or one of them. Periodic axes are continued by copies of the points,
/// wide enough that every Voronoi vertex of a real cell is certain. Points that round to the same
/// place share their neighbours and are not neighbours of each other; collinear points have their
/// neighbours on the line (a pair whose cells meet only farther than 100 extents of the pattern
/// away is no pair).
///
/// Neighbours of point i come in order of direction. Cost O(N), and O(N log N) for the order of
/// insertion.
class Triangulation {
 public:
    enum class Edges { none, measured };

    Triangulation(std::span<const Vec2> points, const Box& box, Edges edges = Edges::none);

    std::size_t size() const { return first_.empty() ? 0 : first_.size() - 1; }
    std::span<const Neighbour> neighbours(std::size_t i) const {
        return {neighbour_.data() + first_[i], neighbour_.data() + first_[i + 1]};
    }

    /// Lengths of the Voronoi edges between point i and its neighbours [length unit of the points],
    /// as much of them as lies between the walls of the box. Only where they were asked for.
    std::span<const double> edges(std::size_t i) const {
        return {edge_.data() + first_[i], edge_.data() + first_[i + 1]};
    }

 private:
    std::vector<std::size_t> first_;
    std::vector<Neighbour> neighbour_;
    std::vector<double> edge_;
};

}  // namespace grainfield::analysis
