#include "analysis/geometry/delaunay.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

namespace grainfield::analysis {
namespace {

__extension__ using Wide = __int128;

constexpr int infinite = -1;  // the corner of triangles beyond the hull
constexpr double epsilon = std::numeric_limits<double>::epsilon() / 2;

struct Step {
    std::int64_t x, y;
};

Step step(const GridPoint& from, const GridPoint& to) {
    return {std::int64_t{to.x} - from.x, std::int64_t{to.y} - from.y};
}

// Twice the area of a, b, p: positive if they turn counterclockwise. Exact: below 2^61.
std::int64_t area(const GridPoint& a, const GridPoint& b, const GridPoint& p) {
    const Step u = step(a, b);
    const Step v = step(a, p);
    return u.x * v.y - u.y * v.x;
}

// Whether p lies inside the circle through a, b, c (counterclockwise).
bool inside_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& p) {
    const Step u = step(p, a);
    const Step v = step(p, b);
    const Step w = step(p, c);
    const auto real = [](std::int64_t i) { return static_cast<double>(i); };
    const double ux = real(u.x), uy = real(u.y);
    const double vx = real(v.x), vy = real(v.y);
    const double wx = real(w.x), wy = real(w.y);
    const double u2 = ux * ux + uy * uy;
    const double v2 = vx * vx + vy * vy;
    const double w2 = wx * wx + wy * wy;
    const double vw = vx * wy, wv = wx * vy;
    const double wu = wx * uy, uw = ux * wy;
    const double uv = ux * vy, vu = vx * uy;
    const double determinant = u2 * (vw - wv) + v2 * (wu - uw) + w2 * (uv - vu);
    const double sizes = u2 * (std::abs(vw) + std::abs(wv)) + v2 * (std::abs(wu) + std::abs(uw)) +
                         w2 * (std::abs(uv) + std::abs(vu));
    // The bound of `shewchuk1997`; the differences are exact here.
    const double bound = 10.1 * epsilon * sizes;
    if (determinant > bound) return true;
    if (determinant < -bound) return false;
    const auto square = [](const Step& s) { return s.x * s.x + s.y * s.y; };
    const auto minor = [](const Step& s, const Step& t) { return s.x * t.y - s.y * t.x; };
    // Each term below 2^122.
    const Wide exact = Wide{square(u)} * minor(v, w) + Wide{square(v)} * minor(w, u) +
                       Wide{square(w)} * minor(u, v);
    return exact > 0;
}

// Place along a Hilbert curve through 2^16 × 2^16 cells.
std::uint32_t hilbert(const GridPoint& p) {
    constexpr unsigned bits = 16;
    const auto cell = [](std::int32_t c) {
        return static_cast<std::uint32_t>(c + Delaunay::most) >> (30U - bits);
    };
    std::uint32_t x = std::min<std::uint32_t>(cell(p.x), (1U << bits) - 1);
    std::uint32_t y = std::min<std::uint32_t>(cell(p.y), (1U << bits) - 1);
    std::uint32_t key = 0;
    for (std::uint32_t s = 1U << (bits - 1); s > 0; s >>= 1U) {
        const std::uint32_t rx = (x & s) != 0 ? 1 : 0;
        const std::uint32_t ry = (y & s) != 0 ? 1 : 0;
        key = 4 * key + ((3 * rx) ^ ry);
        if (ry == 0) {
            if (rx == 1) {
                x = ~x & ((1U << bits) - 1);
                y = ~y & ((1U << bits) - 1);
            }
            std::swap(x, y);
        }
    }
    return key;
}

// Rounds that grow eightfold: 0 is the last one.
std::uint64_t round_of(std::size_t i) {
    std::uint64_t z = (static_cast<std::uint64_t>(i) + 1) * 0x9e3779b97f4a7c15U;
    z = (z ^ (z >> 30U)) * 0xbf58476d1ce4e5b9U;
    z ^= z >> 27U;
    return static_cast<std::uint64_t>(std::min(std::countr_zero(z) / 3, 15));
}

}  // namespace

void Delaunay::sort(std::span<const GridPoint> points) {
    struct Key {
        std::uint64_t place;
        int index;
    };
    std::vector<Key> keys(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::uint64_t round = 15 - round_of(i);
        keys[i] = {round << 32U | hilbert(points[i]), static_cast<int>(i)};
    }
    std::ranges::sort(keys, [](const Key& a, const Key& b) {
        return a.place != b.place ? a.place < b.place : a.index < b.index;
    });
    for (const Key& key : keys) {
        index_.push_back(key.index);
        vertex_.push_back(points[static_cast<std::size_t>(key.index)]);
    }
}

bool Delaunay::is_ghost(const Triangle& t) const {
    return t.corner[0] == infinite || t.corner[1] == infinite || t.corner[2] == infinite;
}

// Whether p lies inside the circle of a triangle; that of one beyond the hull is the half plane
// beyond its edge, and the edge itself.
bool Delaunay::conflicts(int number, const GridPoint& p) const {
    const Triangle& t = triangle(number);
    for (std::size_t k = 0; k < 3; ++k) {
        if (t.corner[k] != infinite) continue;
        const GridPoint& a = at(t.corner[(k + 1) % 3]);
        const GridPoint& b = at(t.corner[(k + 2) % 3]);
        const std::int64_t side = area(a, b, p);
        if (side != 0) return side > 0;
        const Step along = step(a, b);
        const Step here = step(a, p);
        const std::int64_t place = along.x * here.x + along.y * here.y;
        return place > 0 && place < along.x * along.x + along.y * along.y;
    }
    return inside_circle(at(t.corner[0]), at(t.corner[1]), at(t.corner[2]), p);
}

// Walks from triangle to triangle across edges that have p on their other side.
Delaunay::Located Delaunay::locate(const GridPoint& p, int from) const {
    int number = from;
    int before = -1;
    for (;;) {
        const Triangle& t = triangle(number);
        if (is_ghost(t)) return {number, false, 0};
        int beyond = -1;
        for (std::size_t k = 0; k < 3 && beyond < 0; ++k) {
            if (t.next[k] == before) continue;
            if (area(at(t.corner[(k + 1) % 3]), at(t.corner[(k + 2) % 3]), p) < 0) {
                beyond = t.next[k];
            }
        }
        if (beyond < 0) {
            for (const int corner : t.corner) {
                if (at(corner) == p) return {number, true, corner};
            }
            return {number, false, 0};
        }
        before = number;
        number = beyond;
    }
}

void Delaunay::relink(int number, int from, int to) {
    for (int& next : triangle(number).next) {
        if (next == from) {
            next = to;
            return;
        }
    }
}

// Splits a triangle at a new vertex; each of the three parts has it as corner 0.
void Delaunay::split(int number, int vertex) {
    const Triangle old = triangle(number);
    const int second = static_cast<int>(triangle_.size());
    const int third = second + 1;
    triangle(number) = {{vertex, old.corner[0], old.corner[1]}, {old.next[2], second, third}};
    triangle_.push_back({{vertex, old.corner[1], old.corner[2]}, {old.next[0], third, number}});
    triangle_.push_back({{vertex, old.corner[2], old.corner[0]}, {old.next[1], number, second}});
    relink(old.next[0], number, second);
    relink(old.next[1], number, third);
    const auto note = [this](int corner, int t) {
        if (corner != infinite) triangle_of_[static_cast<std::size_t>(corner)] = t;
    };
    note(vertex, number);
    note(old.corner[0], number);
    note(old.corner[1], second);
    note(old.corner[2], third);
    stack_.assign({number, second, third});
}

// Flips edges opposite to the new vertex, corner 0 of the triangles on the stack, until no circle
// beyond them holds it.
void Delaunay::legalise(int vertex) {
    const GridPoint& p = at(vertex);
    while (!stack_.empty()) {
        const int number = stack_.back();
        stack_.pop_back();
        const int other = triangle(number).next[0];
        if (!conflicts(other, p)) continue;
        Triangle& t = triangle(number);
        Triangle& u = triangle(other);
        std::size_t j = 0;
        while (u.next[j] != number) ++j;
        const int a = t.corner[1];
        const int b = t.corner[2];
        const int far = u.corner[j];
        const int beyond_a = u.next[(j + 1) % 3];
        const int beyond_b = u.next[(j + 2) % 3];
        const int beside_b = t.next[1];
        t = {{vertex, a, far}, {beyond_a, other, t.next[2]}};
        u = {{vertex, far, b}, {beyond_b, beside_b, number}};
        relink(beyond_a, other, number);
        relink(beside_b, number, other);
        if (a != infinite) triangle_of_[static_cast<std::size_t>(a)] = number;
        if (b != infinite) triangle_of_[static_cast<std::size_t>(b)] = other;
        if (far != infinite) triangle_of_[static_cast<std::size_t>(far)] = number;
        stack_.push_back(number);
        stack_.push_back(other);
    }
}

// The first triangle, of three vertices that are brought to the front; false if all lie on a line.
bool Delaunay::start() {
    const std::size_t n = vertex_.size();
    std::size_t second = 1;
    while (second < n && vertex_[second] == vertex_[0]) ++second;
    std::size_t third = second + 1;
    while (third < n && area(vertex_[0], vertex_[second], vertex_[third]) == 0) ++third;
    if (third >= n) return false;
    const auto bring = [this](std::size_t from, std::size_t to) {
        std::swap(vertex_[from], vertex_[to]);
        std::swap(index_[from], index_[to]);
    };
    bring(second, 1);
    bring(third, 2);
    if (area(vertex_[0], vertex_[1], vertex_[2]) < 0) bring(1, 2);
    triangle_.reserve(2 * n + 8);
    // The triangle and the three beyond its edges.
    triangle_ = {{{0, 1, 2}, {1, 2, 3}},
                 {{infinite, 2, 1}, {0, 3, 2}},
                 {{infinite, 0, 2}, {0, 1, 3}},
                 {{infinite, 1, 0}, {0, 2, 1}}};
    triangle_of_.assign(n, 0);
    return true;
}

// All vertices on a line: each has the one before and the one behind.
void Delaunay::line_up() {
    std::vector<int> order(vertex_.size());
    for (std::size_t v = 0; v < order.size(); ++v) order[v] = static_cast<int>(v);
    std::ranges::sort(order, [this](int a, int b) {
        const GridPoint& p = at(a);
        const GridPoint& q = at(b);
        if (p.x != q.x) return p.x < q.x;
        return p.y != q.y ? p.y < q.y : a < b;
    });
    line_.assign(order.size(), {-1, -1});
    int last = -1;
    for (const int v : order) {
        if (last >= 0 && at(v) == at(last)) {
            of_point_[static_cast<std::size_t>(index_[static_cast<std::size_t>(v)])] = last;
            continue;
        }
        of_point_[static_cast<std::size_t>(index_[static_cast<std::size_t>(v)])] = v;
        if (last >= 0) {
            line_[static_cast<std::size_t>(last)][1] = v;
            line_[static_cast<std::size_t>(v)][0] = last;
        }
        last = v;
    }
}

Delaunay::Delaunay(std::span<const GridPoint> points) : of_point_(points.size(), -1) {
    if (points.empty()) return;
    vertex_.reserve(points.size());
    index_.reserve(points.size());
    sort(points);
    if (!start()) {
        line_up();
        return;
    }
    int last = 0;
    for (std::size_t v = 0; v < vertex_.size(); ++v) {
        int stands_for = static_cast<int>(v);
        if (v > 2) {
            const Located where = locate(vertex_[v], last);
            if (where.is_taken) {
                stands_for = where.corner;
            } else {
                split(where.triangle, stands_for);
                legalise(stands_for);
            }
        }
        of_point_[static_cast<std::size_t>(index_[v])] = stands_for;
        // A triangle inside the hull to walk from.
        last = triangle_of_[static_cast<std::size_t>(stands_for)];
        while (is_ghost(triangle(last))) {
            const Triangle& t = triangle(last);
            std::size_t k = 0;
            while (t.corner[k] != infinite) ++k;
            last = t.next[k];
        }
    }
}

Vec2 Delaunay::centre(int number) const {
    const Triangle& t = triangle(number);
    const GridPoint& a = at(t.corner[0]);
    const Step u = step(a, at(t.corner[1]));
    const Step v = step(a, at(t.corner[2]));
    const std::int64_t u2 = u.x * u.x + u.y * u.y;
    const std::int64_t v2 = v.x * v.x + v.y * v.y;
    const double twice = 2 * static_cast<double>(u.x * v.y - u.y * v.x);
    // Exact numerators: those of flat triangles are small differences of large numbers.
    const Wide x = Wide{v.y} * u2 - Wide{u.y} * v2;
    const Wide y = Wide{u.x} * v2 - Wide{v.x} * u2;
    return {static_cast<double>(a.x) + static_cast<double>(x) / twice,
            static_cast<double>(a.y) + static_cast<double>(y) / twice};
}

std::array<int, 3> Delaunay::corners(int number) const {
    const Triangle& t = triangle(number);
    if (is_ghost(t)) return {-1, -1, -1};
    std::array<int, 3> points;
    for (std::size_t k = 0; k < 3; ++k) points[k] = index_[static_cast<std::size_t>(t.corner[k])];
    return points;
}

void Delaunay::around(std::size_t i, std::vector<Spoke>& spokes) const {
    spokes.clear();
    const int vertex = of_point_[i];
    if (!line_.empty()) {
        for (const int v : line_[static_cast<std::size_t>(vertex)]) {
            if (v >= 0) spokes.push_back({index_[static_cast<std::size_t>(v)], -1, -1});
        }
        return;
    }
    const auto real = [this](int t) { return is_ghost(triangle(t)) ? -1 : t; };
    const int first = triangle_of_[static_cast<std::size_t>(vertex)];
    int number = first;
    do {
        const Triangle& t = triangle(number);
        std::size_t k = 0;
        while (t.corner[k] != vertex) ++k;
        const int to = t.corner[(k + 1) % 3];
        if (to != infinite) {
            spokes.push_back(
                {index_[static_cast<std::size_t>(to)], real(t.next[(k + 2) % 3]), real(number)});
        }
        number = t.next[(k + 1) % 3];
    } while (number != first);
}

}  // namespace grainfield::analysis
