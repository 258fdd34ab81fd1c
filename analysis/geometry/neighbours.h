#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "analysis/geometry/neighbour_list.h"
#include "core/box.h"

namespace grainfield::analysis {

class PointTree;

/// Points sorted into square cells, for exact searches by distance.
///
/// On periodic axes the nearest image of each other point counts, once, so results are those of
/// the infinite lattice as long as the box is wider than twice the search distance. Points that
/// coincide with the centre have no direction and are no neighbours of it.
///
/// About 1.6 points a cell; a search costs O(1) for patterns of bounded density. Where points crowd
/// into few cells (more than 64 share a cell on average over the points: a stray point far outside,
/// clusters) a tree takes over, O(log N) a search. Construction O(N), or O(N log N) with the tree.
/// Searches are const and thread-safe.
class CellList {
 public:
    CellList(std::span<const Vec2> points, const Box& box);

    std::size_t size() const { return index_.size(); }

    /// Indices of the points in the order in which searching them is kindest to the cache.
    std::span<const int> order() const { return index_; }

    /// What `near` found.
    struct Reach {
        double nearest = 0;     ///< distance of the nearest neighbour
        double mean_first = 0;  ///< mean distance of the `count` nearest (fewer if there are fewer)
        int count = 0;          ///< how many of the `count` nearest exist
    };

    /// The k nearest neighbours of point i, and all further ones with r < factor × their mean
    /// distance, in no particular order. factor = 0: exactly the k nearest (among equal distances
    /// an arbitrary one). 1 ≤ k ≤ 16.
    Reach near(int i, int k, double factor, NeighbourList& out) const;

    /// All neighbours of point i with r < radius, in no particular order.
    void within(int i, double radius, NeighbourList& out) const;

    /// The cells along one axis.
    struct Axis {
        double origin = 0;
        double length = 0;
        double width = 1;  ///< of a cell
        double cells_per_length = 1;
        int cells = 1;
        bool periodic = false;
        int cell_of(double x) const;
    };

    /// What kernels that go from cell to cell need. The points stand in the order of the cells,
    /// rows of `x.cells` of them; a tree in place of the cells says that points crowd.
    struct View {
        Axis x, y;
        const int* first;  ///< of each cell, and the end
        const double* at_x;
        const double* at_y;
        const int* index;  ///< original
        bool has_tree;
    };
    View view() const {
        return {x_, y_, first_.data(), at_x_.data(), at_y_.data(), index_.data(), tree_ != nullptr};
    }

 private:
    Reach near_in_tree(Vec2 centre, int k, double factor, NeighbourList& out) const;
    double gather(Vec2 centre, int rings, NeighbourList& out) const;
    void take(int first, int last, Vec2 centre, NeighbourList& out) const;
    Vec2 place(std::size_t at) const { return {at_x_[at], at_y_[at]}; }

    Axis x_, y_;
    Box box_;
    std::vector<int> first_;                 // of each cell, in cell order; one extra
    std::vector<double> at_x_, at_y_;        // in cell order
    std::vector<int> index_;                 // original index, in cell order
    std::vector<int> place_;                 // place in cell order of each original index
    std::shared_ptr<const PointTree> tree_;  // instead of the cells, if points crowd
};

}  // namespace grainfield::analysis
