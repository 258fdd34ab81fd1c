#include "analysis/geometry/triangulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "analysis/geometry/delaunay.h"

namespace grainfield::analysis {
namespace {

// A point of the continued pattern: an original point and the lattice vector it was moved by.
struct Copy {
    Vec2 at;
    int index;
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

// Maps the pattern to a grid of integers.
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
        if (half > 0) scale = double{Delaunay::most} / half;
    }
    GridPoint to_grid(Vec2 p) const {
        return {static_cast<std::int32_t>(std::lround((p.x - centre.x) * scale)),
                static_cast<std::int32_t>(std::lround((p.y - centre.y) * scale))};
    }
    Vec2 from_grid(Vec2 p) const { return {p.x / scale + centre.x, p.y / scale + centre.y}; }
};

bool any_periodic(const Box& box) {
    return box.boundary[0] == Boundary::periodic || box.boundary[1] == Boundary::periodic;
}

// Makes the lists of one pattern.
class Lists {
 public:
    Lists(std::span<const Vec2> points, const Box& box, double margin)
        : points_(points),
          box_(box),
          margin_(margin),
          copies_(continued(points, box, margin)),
          scaling_(copies_),
          delaunay_(on_grid(copies_, scaling_)) {
        const double near = 50 * scaling_.extent;
        for (int t = 0; t < delaunay_.triangles(); ++t) {
            vertex_.push_back(centre_of(t));
            const double r2 = squared_norm(vertex_.back() - scaling_.centre);
            is_near_.push_back(r2 < near * near ? 1 : 0);
        }
    }

    // False if the margin was too narrow.
    bool fill(bool must_be_certain, bool wants_edges, std::vector<std::size_t>& first,
              std::vector<Neighbour>& neighbours, std::vector<double>& edges);

 private:
    static std::vector<GridPoint> on_grid(const std::vector<Copy>& copies, const Scaling& scaling) {
        std::vector<GridPoint> grid(copies.size());
        for (std::size_t c = 0; c < grid.size(); ++c) grid[c] = scaling.to_grid(copies[c].at);
        return grid;
    }
    Vec2 centre_of(int triangle) const;
    Vec2 vertex(int triangle) const { return vertex_[static_cast<std::size_t>(triangle)]; }
    bool is_certain(int triangle, Vec2 site) const;
    bool is_near(int triangle) const {
        return triangle >= 0 && is_near_[static_cast<std::size_t>(triangle)] != 0;
    }
    double edge_length(const Delaunay::Spoke& spoke, Vec2 site, Vec2 d) const;

    std::span<const Vec2> points_;
    const Box& box_;
    double margin_;
    std::vector<Copy> copies_;
    Scaling scaling_;
    Delaunay delaunay_;
    std::vector<Vec2> vertex_;           // of the Voronoi diagram, by triangle
    std::vector<std::uint8_t> is_near_;  // whether it lies within 50 extents
};

// From the points as they are; where rounding to the grid may have turned a flat triangle over,
// from the grid.
Vec2 Lists::centre_of(int triangle) const {
    const std::array<int, 3> corner = delaunay_.corners(triangle);
    if (corner[0] < 0) return {};
    const auto at = [&](std::size_t k) { return copies_[static_cast<std::size_t>(corner[k])].at; };
    const Vec2 u = at(1) - at(0);
    const Vec2 v = at(2) - at(0);
    const double u2 = squared_norm(u);
    const double v2 = squared_norm(v);
    const double area = u.x * v.y - u.y * v.x;
    const double grid = 1 / scaling_.scale;
    if (!(area > 1e-6 * (u2 + v2) && area > 1e3 * grid * std::sqrt(u2 + v2))) {
        return scaling_.from_grid(delaunay_.centre(triangle));
    }
    return at(0) + 0.5 / area * Vec2{v.y * u2 - u.y * v2, u.x * v2 - v.x * u2};
}

// Whether the circle around a Voronoi vertex through its sites lies in the continued region, so
// that no point beyond the margin could have cut it.
bool Lists::is_certain(int triangle, Vec2 site) const {
    if (triangle < 0) return false;
    const Vec2 v = vertex(triangle);
    const double r = norm(v - site);
    const Vec2 high = box_.origin + box_.length;
    const auto inside = [&](double at, double low, double top) {
        return at - r >= low - margin_ && at + r <= top + margin_;
    };
    if (box_.boundary[0] == Boundary::periodic && !inside(v.x, box_.origin.x, high.x)) return false;
    return box_.boundary[1] != Boundary::periodic || inside(v.y, box_.origin.y, high.y);
}

// Length of the Voronoi edge between `site` and site + d, as much of it as lies between the walls;
// −1 for pairs that are none: points on a line come out of the rounding with flat triangles whose
// centres lie far outside, and touch only there.
double Lists::edge_length(const Delaunay::Spoke& spoke, Vec2 site, Vec2 d) const {
    const double length = std::sqrt(squared_norm(d));
    const Vec2 along{-d.y / length, d.x / length};
    const Vec2 middle = site + 0.5 * d;
    constexpr double unbounded = std::numeric_limits<double>::infinity();
    const auto place = [&](int triangle, double otherwise) {
        return triangle < 0 ? otherwise : dot(vertex(triangle) - middle, along);
    };
    // From the one on the right to that on the left.
    double from = place(spoke.right, -unbounded);
    double to = place(spoke.left, unbounded);
    const double far = 100 * scaling_.extent;
    if (from > far || to < -far) return -1;
    const auto clip = [&](double Vec2::*axis, Boundary boundary) {
        if (boundary == Boundary::periodic) return;
        const double low = box_.origin.*axis - middle.*axis;
        const double high = low + box_.length.*axis;
        const double slope = along.*axis;
        if (slope == 0) {
            if (low > 0 || high < 0) to = from;
            return;
        }
        from = std::max(from, slope > 0 ? low / slope : high / slope);
        to = std::min(to, slope > 0 ? high / slope : low / slope);
    };
    clip(&Vec2::x, box_.boundary[0]);
    clip(&Vec2::y, box_.boundary[1]);
    return to > from ? to - from : 0;
}

bool Lists::fill(bool must_be_certain, bool wants_edges, std::vector<std::size_t>& first,
                 std::vector<Neighbour>& neighbours, std::vector<double>& edges) {
    first.assign(points_.size() + 1, 0);
    std::vector<Delaunay::Spoke> spokes;
    // In the order of the curve along which the triangulation lies in memory; the lists are put in
    // order of the points afterwards.
    std::vector<Neighbour> found;
    std::vector<double> length;
    std::vector<std::size_t> begin(points_.size(), 0);
    found.reserve(6 * points_.size());
    if (wants_edges) length.reserve(6 * points_.size());
    for (const int c : delaunay_.order()) {
        const auto i = static_cast<std::size_t>(c);
        if (i >= points_.size()) continue;  // a copy
        begin[i] = found.size();
        delaunay_.around(i, spokes);
        for (const Delaunay::Spoke& spoke : spokes) {
            if (must_be_certain &&
                !(is_certain(spoke.left, points_[i]) && is_certain(spoke.right, points_[i]))) {
                return false;
            }
            const Copy& to = copies_[static_cast<std::size_t>(spoke.to)];
            const Vec2 d = to.at - points_[i];
            const bool is_sure = is_near(spoke.left) && is_near(spoke.right);
            const double edge = wants_edges || !is_sure ? edge_length(spoke, points_[i], d) : 0;
            if (edge < 0) continue;
            found.push_back({to.index, d, squared_norm(d)});
            if (wants_edges) length.push_back(edge);
        }
        first[i + 1] = found.size() - begin[i];
    }
    for (std::size_t i = 0; i < points_.size(); ++i) first[i + 1] += first[i];
    neighbours.resize(found.size());
    edges.resize(length.size());
    for (std::size_t i = 0; i < points_.size(); ++i) {
        const auto from = static_cast<std::ptrdiff_t>(begin[i]);
        const auto to = static_cast<std::ptrdiff_t>(first[i]);
        const std::size_t count = first[i + 1] - first[i];
        std::copy_n(found.begin() + from, count, neighbours.begin() + to);
        if (wants_edges) std::copy_n(length.begin() + from, count, edges.begin() + to);
    }
    return true;
}

}  // namespace

Triangulation::Triangulation(std::span<const Vec2> points, const Box& box, Edges edges) {
    const bool wants_edges = edges == Edges::measured;
    if (points.empty()) {
        first_.assign(1, 0);
        return;
    }
    if (!any_periodic(box)) {
        Lists(points, box, 0).fill(false, wants_edges, first_, neighbour_, edge_);
        return;
    }
    const double longest = std::max(box.length.x, box.length.y);
    double margin =
        std::min(4 * std::sqrt(box.area() / static_cast<double>(points.size())), 2 * longest);
    // Twice the longer side is enough for any pattern with all axes periodic. With one walled axis
    // the outermost cells stay unbounded and the widest margin is taken as it is.
    while (!Lists(points, box, margin)
                .fill(margin < 2 * longest, wants_edges, first_, neighbour_, edge_)) {
        margin = std::min(2 * margin, 2 * longest);
    }
}

}  // namespace grainfield::analysis
