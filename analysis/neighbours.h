#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "core/box.h"

namespace grainfield::analysis {

/// A neighbour of a point: which one, and the vector to it [length unit of the points].
struct Neighbour {
    int index;
    Vec2 d;
    double r2;  ///< |d|²
};

/// Points sorted into square cells, for exact searches by distance.
///
/// On periodic axes the nearest image of each other point counts, once, so results are those of
/// the infinite lattice as long as the box is wider than twice the search distance. Points that
/// coincide with the centre have no direction and are no neighbours of it.
///
/// About 1.6 points a cell; a search costs O(1) for patterns of bounded density and O(N) where all
/// points crowd into one cell. Construction O(N). Searches are const and thread-safe.
class CellList {
 public:
    CellList(std::span<const Vec2> points, const Box& box);

    std::size_t size() const { return point_.size(); }

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
    /// an arbitrary one). 1 ≤ k ≤ 64.
    Reach near(int i, int k, double factor, std::vector<Neighbour>& out) const;

    /// All neighbours of point i with r < radius, in no particular order.
    void within(int i, double radius, std::vector<Neighbour>& out) const;

 private:
    struct Axis {
        double origin = 0;
        double length = 0;
        double width = 1;  ///< of a cell
        int cells = 1;
        bool periodic = false;
        int cell_of(double x) const;
    };
    double gather(Vec2 centre, int self, int rings, std::vector<Neighbour>& out) const;
    void take(int first, int last, Vec2 centre, int self, std::vector<Neighbour>& out) const;

    Axis x_, y_;
    Box box_;
    std::vector<int> first_;   // of each cell, in cell order; one extra
    std::vector<Vec2> point_;  // in cell order
    std::vector<int> index_;   // original index, in cell order
    std::vector<int> place_;   // place in cell order of each original index
};

}  // namespace grainfield::analysis
