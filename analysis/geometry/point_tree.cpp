#include "analysis/geometry/point_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace grainfield::analysis {
namespace {

constexpr int most_in_leaf = 8;

// Distance on one axis from x to the interval [low, high], over all images if periodic.
double gap(double x, double low, double high, double length, bool periodic) {
    const double direct = std::max({low - x, x - high, 0.0});
    if (!periodic || direct == 0) return direct;
    return std::min({direct, std::abs(low + length - x), std::abs(x - (high - length))});
}

}  // namespace

PointTree::PointTree(std::span<const Vec2> points, const Box& box)
    : box_(box), point_(points.begin(), points.end()), index_(points.size()) {
    std::iota(index_.begin(), index_.end(), 0);
    if (points.empty()) return;
    nodes_.push_back({{}, {}, 0, static_cast<int>(points.size()), -1});
    for (std::size_t n = 0; n < nodes_.size(); ++n) split(static_cast<int>(n));
    for (std::size_t i = 0; i < index_.size(); ++i) {
        point_[i] = points[static_cast<std::size_t>(index_[i])];
    }
}

// `point_` is still in the order of the indices here.
void PointTree::split(int at) {
    Node node = nodes_[static_cast<std::size_t>(at)];
    const auto point = [this](int i) { return point_[static_cast<std::size_t>(i)]; };
    const auto begin = index_.begin();
    node.low = node.high = point(begin[node.first]);
    for (int i = node.first; i < node.last; ++i) {
        const Vec2 p = point(begin[i]);
        node.low = {std::min(node.low.x, p.x), std::min(node.low.y, p.y)};
        node.high = {std::max(node.high.x, p.x), std::max(node.high.y, p.y)};
    }
    const Vec2 size = node.high - node.low;
    if (node.last - node.first > most_in_leaf && (size.x > 0 || size.y > 0)) {
        double Vec2::*axis = size.x >= size.y ? &Vec2::x : &Vec2::y;
        const int middle = (node.first + node.last) / 2;
        // Ties by index: the tree does not depend on the library's sorting.
        std::nth_element(begin + node.first, begin + middle, begin + node.last, [&](int a, int b) {
            const double u = point(a).*axis;
            const double v = point(b).*axis;
            return u != v ? u < v : a < b;
        });
        node.left = static_cast<int>(nodes_.size());
        nodes_.push_back({{}, {}, node.first, middle, -1});
        nodes_.push_back({{}, {}, middle, node.last, -1});
    }
    nodes_[static_cast<std::size_t>(at)] = node;
}

// Squared distance from the centre to the box of a node.
double PointTree::distance(const Node& node, Vec2 centre) const {
    const double x = gap(centre.x, node.low.x, node.high.x, box_.length.x,
                         box_.boundary[0] == Boundary::periodic);
    const double y = gap(centre.y, node.low.y, node.high.y, box_.length.y,
                         box_.boundary[1] == Boundary::periodic);
    return x * x + y * y;
}

template <class Visit>
void PointTree::visit_leaf(const Node& node, Vec2 centre, const Visit& visit) const {
    if (node.low == node.high && node.low == centre) return;  // all coincide with the centre
    for (int i = node.first; i < node.last; ++i) {
        const auto place = static_cast<std::size_t>(i);
        const Vec2 d = box_.minimum_image(point_[place] - centre);
        const double r2 = squared_norm(d);
        if (r2 > 0) visit(Neighbour{index_[place], d, r2});
    }
}

void PointTree::nearest(Vec2 centre, int k, NeighbourList& out) const {
    out.clear();
    if (nodes_.empty() || k < 1) return;
    std::vector<Neighbour> best;  // sorted
    const auto limit = [&] {
        return static_cast<int>(best.size()) < k ? std::numeric_limits<double>::infinity()
                                                 : best.back().r2;
    };
    const auto take = [&](const Neighbour& neighbour) {
        if (!(neighbour.r2 < limit())) return;
        if (static_cast<int>(best.size()) == k) best.pop_back();
        const auto place =
            std::upper_bound(best.begin(), best.end(), neighbour,
                             [](const Neighbour& a, const Neighbour& b) { return a.r2 < b.r2; });
        best.insert(place, neighbour);
    };
    std::vector<std::pair<double, int>> open{{distance(nodes_[0], centre), 0}};
    while (!open.empty()) {
        const auto [away, at] = open.back();
        open.pop_back();
        if (!(away < limit())) continue;
        const Node& node = nodes_[static_cast<std::size_t>(at)];
        if (node.left < 0) {
            visit_leaf(node, centre, take);
            continue;
        }
        std::array<std::pair<double, int>, 2> children;
        for (int c = 0; c < 2; ++c) {
            const int child = node.left + c;
            children[static_cast<std::size_t>(c)] = {
                distance(nodes_[static_cast<std::size_t>(child)], centre), child};
        }
        // The nearer one on top.
        if (children[0].first < children[1].first) std::swap(children[0], children[1]);
        open.insert(open.end(), children.begin(), children.end());
    }
    for (const Neighbour& neighbour : best) {
        *out.room(1) = neighbour;
        out.grow(1);
    }
}

void PointTree::within(Vec2 centre, double limit, NeighbourList& out) const {
    out.clear();
    if (nodes_.empty()) return;
    std::vector<int> open{0};
    while (!open.empty()) {
        const Node& node = nodes_[static_cast<std::size_t>(open.back())];
        open.pop_back();
        if (!(distance(node, centre) < limit)) continue;
        if (node.left >= 0) {
            open.insert(open.end(), {node.left, node.left + 1});
            continue;
        }
        visit_leaf(node, centre, [&](const Neighbour& neighbour) {
            if (!(neighbour.r2 < limit)) return;
            *out.room(1) = neighbour;
            out.grow(1);
        });
    }
}

}  // namespace grainfield::analysis
