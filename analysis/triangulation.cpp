#include "analysis/triangulation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include <boost/polygon/voronoi.hpp>

namespace grainfield::analysis {
namespace {

using Diagram = boost::polygon::voronoi_diagram<double>;
using Site = boost::polygon::point_data<std::int32_t>;

// A point of the continued pattern: an original point and the lattice vector it was moved by.
struct Copy {
    Vec2 at;
    int index;
};

struct Region {
    Vec2 low;
    Vec2 high;
};

std::vector<Copy> continued(std::span<const Vec2> points, const Box& box, double margin) {
    std::vector<Copy> copies;
    const bool px = box.boundary[0] == Boundary::periodic;
    const bool py = box.boundary[1] == Boundary::periodic;
    const int nx = px ? static_cast<int>(std::ceil(margin / box.length.x)) : 0;
    const int ny = py ? static_cast<int>(std::ceil(margin / box.length.y)) : 0;
    const Vec2 high = box.origin + box.length;
    copies.reserve(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        copies.push_back({points[i], static_cast<int>(i)});
    }
    for (int sy = -ny; sy <= ny; ++sy) {
        for (int sx = -nx; sx <= nx; ++sx) {
            if (sx == 0 && sy == 0) continue;
            for (std::size_t i = 0; i < points.size(); ++i) {
                const Vec2 p = points[i] + Vec2{sx * box.length.x, sy * box.length.y};
                if (px && (p.x < box.origin.x - margin || p.x > high.x + margin)) continue;
                if (py && (p.y < box.origin.y - margin || p.y > high.y + margin)) continue;
                copies.push_back({p, static_cast<int>(i)});
            }
        }
    }
    return copies;
}

// Maps the pattern to integers of at most 30 bits and a sign.
struct Scaling {
    Vec2 centre;
    double scale = 1;
    double extent = 0;

    explicit Scaling(const std::vector<Copy>& copies) {
        if (copies.empty()) return;
        Vec2 low = copies.front().at;
        Vec2 high = low;
        for (const Copy& c : copies) {
            low = {std::min(low.x, c.at.x), std::min(low.y, c.at.y)};
            high = {std::max(high.x, c.at.x), std::max(high.y, c.at.y)};
        }
        centre = 0.5 * (low + high);
        const double half = 0.5 * std::max(high.x - low.x, high.y - low.y);
        extent = 2 * half;
        if (half > 0) scale = double{1 << 30} / half;
    }
    Site site(Vec2 p) const {
        return {static_cast<std::int32_t>(std::lround((p.x - centre.x) * scale)),
                static_cast<std::int32_t>(std::lround((p.y - centre.y) * scale))};
    }
    Vec2 point(double x, double y) const { return {x / scale + centre.x, y / scale + centre.y}; }
};

struct Sites {
    std::vector<Site> site;           // distinct
    std::vector<int> representative;  // copy index of each site
    std::vector<int> of_copy;         // site of each copy

    Sites(const std::vector<Copy>& copies, const Scaling& scaling) {
        std::vector<Site> all(copies.size());
        for (std::size_t c = 0; c < copies.size(); ++c) all[c] = scaling.site(copies[c].at);
        std::vector<int> order(copies.size());
        std::iota(order.begin(), order.end(), 0);
        const auto less = [&](int a, int b) {
            const Site& p = all[static_cast<std::size_t>(a)];
            const Site& q = all[static_cast<std::size_t>(b)];
            if (p.x() != q.x()) return p.x() < q.x();
            return p.y() != q.y() ? p.y() < q.y() : a < b;
        };
        std::sort(order.begin(), order.end(), less);
        of_copy.resize(copies.size());
        for (int c : order) {
            const Site& s = all[static_cast<std::size_t>(c)];
            if (site.empty() || !(s == site.back())) {
                site.push_back(s);
                representative.push_back(c);
            }
            of_copy[static_cast<std::size_t>(c)] = static_cast<int>(site.size()) - 1;
        }
    }
};

// Whether the circle around a Voronoi vertex through its sites lies in the continued region, so
// that no point beyond the margin could have cut it.
bool certain(const Diagram::edge_type& edge, const Scaling& scaling, Vec2 site, const Box& box,
             double margin) {
    for (const auto* vertex : {edge.vertex0(), edge.vertex1()}) {
        if (vertex == nullptr) return false;
        const Vec2 v = scaling.point(vertex->x(), vertex->y());
        const double r = norm(v - site);
        const Vec2 high = box.origin + box.length;
        if (box.boundary[0] == Boundary::periodic &&
            (v.x - r < box.origin.x - margin || v.x + r > high.x + margin)) {
            return false;
        }
        if (box.boundary[1] == Boundary::periodic &&
            (v.y - r < box.origin.y - margin || v.y + r > high.y + margin)) {
            return false;
        }
    }
    return true;
}

// Whether the Voronoi edge between `site` and site + d passes within `far` of their midpoint.
// Points on a line come out of the rounding with flat triangles whose vertices lie far outside;
// such pairs only touch there and are no neighbours.
bool passes_near(const Diagram::edge_type& edge, const Scaling& scaling, Vec2 site, Vec2 d,
                 double far) {
    // Along the edge the cell of `site` is on the left.
    const double length = norm(d);
    const Vec2 along{-d.y / length, d.x / length};
    const Vec2 middle = site + 0.5 * d;
    const auto place = [&](const Diagram::vertex_type* vertex) {
        return dot(scaling.point(vertex->x(), vertex->y()) - middle, along);
    };
    if (edge.vertex0() != nullptr && place(edge.vertex0()) > far) return false;
    return edge.vertex1() == nullptr || place(edge.vertex1()) >= -far;
}

bool any_periodic(const Box& box) {
    return box.boundary[0] == Boundary::periodic || box.boundary[1] == Boundary::periodic;
}

// False if the margin was too narrow.
bool build(std::span<const Vec2> points, const Box& box, double margin, bool must_be_certain,
           std::vector<std::size_t>& first, std::vector<Neighbour>& neighbours) {
    const std::vector<Copy> copies = continued(points, box, margin);
    const Scaling scaling(copies);
    const Sites sites(copies, scaling);
    Diagram diagram;
    boost::polygon::construct_voronoi(sites.site.begin(), sites.site.end(), &diagram);
    std::vector<const Diagram::cell_type*> cell(sites.site.size(), nullptr);
    for (const auto& c : diagram.cells()) cell[c.source_index()] = &c;

    first.assign(1, 0);
    neighbours.clear();
    neighbours.reserve(6 * points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto* own = cell[static_cast<std::size_t>(sites.of_copy[i])];
        const auto* start = own != nullptr ? own->incident_edge() : nullptr;
        const auto* edge = start;
        while (edge != nullptr) {
            if (must_be_certain && !certain(*edge, scaling, points[i], box, margin)) return false;
            const std::size_t other = edge->twin()->cell()->source_index();
            const Copy& to = copies[static_cast<std::size_t>(sites.representative[other])];
            const Vec2 d = to.at - points[i];
            if (passes_near(*edge, scaling, points[i], d, 100 * scaling.extent)) {
                neighbours.push_back({to.index, d, squared_norm(d)});
            }
            edge = edge->next();
            if (edge == start) break;
        }
        first.push_back(neighbours.size());
    }
    return true;
}

}  // namespace

Triangulation::Triangulation(std::span<const Vec2> points, const Box& box) {
    if (points.empty()) {
        first_.assign(1, 0);
        return;
    }
    if (!any_periodic(box)) {
        build(points, box, 0, false, first_, neighbour_);
        return;
    }
    const double longest = std::max(box.length.x, box.length.y);
    double margin =
        std::min(4 * std::sqrt(box.area() / static_cast<double>(points.size())), 2 * longest);
    // Twice the longer side is enough for any pattern with all axes periodic; with one walled axis
    // the outermost cells stay unbounded and the widest margin is taken as it is.
    while (!build(points, box, margin, margin < 2 * longest, first_, neighbour_)) {
        margin = std::min(2 * margin, 2 * longest);
    }
}

}  // namespace grainfield::analysis
