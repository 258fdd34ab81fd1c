#pragma once

#include <span>
#include <vector>

#include "analysis/geometry/neighbour_list.h"
#include "core/box.h"

namespace grainfield::analysis {

/// Points in a binary tree of boxes (`bentley1975`), for exact searches by distance where cells of
/// one size are no use: clusters, stray points far outside, many points at one place.
///
/// Each node splits its points at the median of the longer side. Distances on periodic axes are to
/// the nearest image. Points that coincide with the centre are no neighbours of it, and a node that
/// holds nothing else is passed over as a whole. A search costs O(log N + found) for any
/// distribution of distinct points. Construction O(N log N). Searches are const and thread-safe.
class PointTree {
 public:
    PointTree(std::span<const Vec2> points, const Box& box);

    /// The k nearest of `centre`, in ascending order; fewer if there are fewer.
    void nearest(Vec2 centre, int k, NeighbourList& out) const;

    /// All with r² < limit, in no particular order.
    void within(Vec2 centre, double limit, NeighbourList& out) const;

 private:
    struct Node {
        Vec2 low, high;           // box of its points
        int first = 0, last = 0;  // places
        int left = -1;            // the right child follows at left + 1; -1: a leaf
    };
    void split(int node);
    double distance(const Node& node, Vec2 centre) const;
    template <class Visit>
    void visit_leaf(const Node& node, Vec2 centre, const Visit& visit) const;

    Box box_;
    std::vector<Vec2> point_;  // in the order of the leaves
    std::vector<int> index_;
    std::vector<Node> nodes_;
};

}  // namespace grainfield::analysis
