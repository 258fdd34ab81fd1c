#include "simulate/render/optics/disc_union.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

namespace grainfield::simulate {

namespace {

// A small list that only grows onto the heap in absurd scenes.
class Breaks {
 public:
    void add(double y) {
        if (y > -0.5 && y < 0.5) values_.push_back(y);
    }
    std::vector<double>& sorted() {
        values_.push_back(-0.5);
        values_.push_back(0.5);
        std::sort(values_.begin(), values_.end());
        return values_;
    }
    void clear() { values_.clear(); }

 private:
    std::vector<double> values_;
};

void add_crossings(const Disc& d, Breaks& breaks) {
    breaks.add(d.centre.y - d.radius);
    breaks.add(d.centre.y + d.radius);
    for (const double side : {-0.5, 0.5}) {
        const double u = side - d.centre.x;
        const double square = d.radius * d.radius - u * u;
        if (square <= 0) continue;
        const double k = std::sqrt(square);
        breaks.add(d.centre.y - k);
        breaks.add(d.centre.y + k);
    }
}

void add_intersections(const Disc& a, const Disc& b, Breaks& breaks) {
    const Vec2 d = b.centre - a.centre;
    const double d2 = squared_norm(d);
    if (d2 == 0) return;
    const double along = 0.5 * (1 + (a.radius * a.radius - b.radius * b.radius) / d2);
    const double across2 = a.radius * a.radius / d2 - along * along;
    if (across2 <= 0) return;
    const double across = std::sqrt(across2);
    breaks.add(a.centre.y + along * d.y + across * d.x);
    breaks.add(a.centre.y + along * d.y - across * d.x);
}

double cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}

constexpr double least_radius = 2;  // [px] of discs whose arcs in a pixel are short

// Some points of a pixel.
struct Points {
    std::array<Vec2, 8> at;
    std::size_t count = 0;
    void add(Vec2 p) { at[count++] = p; }
};

// Where two circles cross within the pixel at the origin; nothing if they are the same.
std::optional<Points> crossings(const Disc& a, const Disc& b) {
    const Vec2 d = b.centre - a.centre;
    const double d2 = squared_norm(d);
    if (d2 == 0) return std::nullopt;
    Points points;
    const double along = 0.5 * (1 + (a.radius * a.radius - b.radius * b.radius) / d2);
    const double across2 = a.radius * a.radius / d2 - along * along;
    if (across2 < 0) return points;
    const double across = std::sqrt(across2);
    const Vec2 foot = a.centre + along * d;
    const Vec2 off{-across * d.y, across * d.x};
    for (const Vec2 p : {foot + off, foot - off}) {
        if (std::abs(p.x) <= 0.5 && std::abs(p.y) <= 0.5) points.add(p);
    }
    return points;
}

bool holds(const Disc& disc, Vec2 p) {
    return squared_norm(p - disc.centre) < disc.radius * disc.radius;
}

// Where a circle enters the pixel or leaves it.
struct Entries {
    Points points;
    std::size_t inside = 0;  // of them in the other disc
    Vec2 last_inside{};

    Entries(const Disc& disc, const Disc& other) {
        const double r2 = disc.radius * disc.radius;
        for (const double border : {-0.5, 0.5}) {
            const double u = border - disc.centre.x;
            const double v = border - disc.centre.y;
            if (u * u < r2) {
                const double k = std::sqrt(r2 - u * u);
                if (std::abs(disc.centre.y - k) <= 0.5) points.add({border, disc.centre.y - k});
                if (std::abs(disc.centre.y + k) <= 0.5) points.add({border, disc.centre.y + k});
            }
            if (v * v < r2) {
                const double k = std::sqrt(r2 - v * v);
                if (std::abs(disc.centre.x - k) <= 0.5) points.add({disc.centre.x - k, border});
                if (std::abs(disc.centre.x + k) <= 0.5) points.add({disc.centre.x + k, border});
            }
        }
        for (std::size_t i = 0; i < points.count; ++i) {
            if (!holds(other, points.at[i])) continue;
            ++inside;
            last_inside = points.at[i];
        }
    }
    bool all_inside() const { return points.count > 0 && inside == points.count; }
    bool all_outside() const { return points.count > 0 && inside == 0; }
    bool one_of_two() const { return points.count == 2 && inside == 1; }
};

// Between a chord and its arc, the shorter one: R² (asin s − s √(1 − s²)), s = chord/(2R). Within a
// pixel s < 0.36 for R ≥ 2: what is left out is below 1e-6 px² there.
double segment(double chord2, double radius) {
    const double r2 = radius * radius;
    const double s2 = chord2 / (4 * r2);
    return r2 * s2 * std::sqrt(s2) *
           (2.0 / 3 + s2 * (1.0 / 5 + s2 * (3.0 / 28 + s2 * (5.0 / 72 + s2 * (35.0 / 704)))));
}

// What two discs share of the pixel if their circles cross once in it and each leaves it once
// inside the other. Convex: corners of the pixel between the ends of two arcs that begin at the
// crossing.
double lens(const Disc& a, Vec2 end_a, const Disc& b, Vec2 end_b, Vec2 crossing) {
    std::array<Vec2, 6> rim{end_a - crossing, end_b - crossing};
    std::size_t n = 2;
    const double turn = cross(rim[0], rim[1]) < 0 ? -1 : 1;
    for (const Vec2 corner : {Vec2{-0.5, -0.5}, Vec2{0.5, -0.5}, Vec2{0.5, 0.5}, Vec2{-0.5, 0.5}}) {
        if (!holds(a, corner) || !holds(b, corner)) continue;
        const Vec2 p = corner - crossing;
        std::size_t at = n++;
        for (; at > 1 && (at == n - 1 || turn * cross(p, rim[at - 1]) > 0); --at) {
            rim[at] = rim[at - 1];
        }
        rim[at] = p;
    }
    double doubled = 0;
    for (std::size_t i = 0; i + 1 < n; ++i) doubled += cross(rim[i], rim[i + 1]);
    return 0.5 * std::abs(doubled) + segment(squared_norm(rim[0]), a.radius) +
           segment(squared_norm(rim[n - 1]), b.radius);
}

using Spans = std::vector<std::pair<double, double>>;

// Length of the union of the discs' chords at height y, within the pixel.
double covered_length(const std::vector<Disc>& discs, double y, Spans& spans) {
    spans.clear();
    for (const Disc& d : discs) {
        const double t = y - d.centre.y;
        const double square = d.radius * d.radius - t * t;
        if (square <= 0) continue;
        const double h = std::sqrt(square);
        const double low = std::max(d.centre.x - h, -0.5);
        const double high = std::min(d.centre.x + h, 0.5);
        if (low >= high) continue;
        auto at = spans.end();
        while (at != spans.begin() && std::prev(at)->first > low) --at;
        spans.insert(at, {low, high});
    }
    double length = 0;
    double reached = -0.5;
    for (const auto& [low, high] : spans) {
        if (high <= reached) continue;
        length += high - std::max(low, reached);
        reached = high;
    }
    return length;
}

}  // namespace

std::optional<double> union_of_two(const Disc& a, double area_a, const Disc& b, double area_b,
                                   int x, int y) {
    const Vec2 pixel{static_cast<double>(x), static_cast<double>(y)};
    const Disc first{a.centre - pixel, a.radius};
    const Disc second{b.centre - pixel, b.radius};
    const std::optional<Points> crossing = crossings(first, second);
    if (!crossing) return std::nullopt;
    const Entries of_first(first, second);
    const Entries of_second(second, first);
    if (crossing->count == 0) {
        if (of_first.all_outside() && of_second.all_outside()) return area_a + area_b;
        if (of_first.all_inside() && of_second.all_inside()) return 1;
        const bool one_in_other = (of_first.all_inside() && of_second.all_outside()) ||
                                  (of_first.all_outside() && of_second.all_inside());
        return one_in_other ? std::optional(std::max(area_a, area_b)) : std::nullopt;
    }
    if (crossing->count > 1 || !of_first.one_of_two() || !of_second.one_of_two() ||
        std::min(a.radius, b.radius) < least_radius) {
        return std::nullopt;
    }
    const double shared =
        lens(first, of_first.last_inside, second, of_second.last_inside, crossing->at[0]);
    return std::clamp(area_a + area_b - shared, std::max(area_a, area_b), 1.0);
}

double union_area(const Disc* discs, int count, int x, int y) {
    thread_local std::vector<Disc> local;
    thread_local Breaks breaks;
    thread_local Spans spans;
    local.assign(discs, discs + count);
    breaks.clear();
    for (Disc& d : local) d.centre -= {static_cast<double>(x), static_cast<double>(y)};
    for (std::size_t i = 0; i < local.size(); ++i) {
        add_crossings(local[i], breaks);
        for (std::size_t j = 0; j < i; ++j) add_intersections(local[i], local[j], breaks);
    }
    // Four Gauss points in u, t = 3u² − 2u³ along a piece: at its ends chords may go as √t.
    constexpr double inner = 0.3399810435848563;
    constexpr double outer = 0.8611363115940526;
    constexpr double weight_inner = 0.6521451548625461 / 2;
    constexpr double weight_outer = 0.3478548451374538 / 2;
    constexpr auto node = [](double at, double weight) {
        const double u = 0.5 * (1 + at);
        return std::pair{u * u * (3 - 2 * u), 6 * u * (1 - u) * weight};
    };
    constexpr std::array<std::pair<double, double>, 4> gauss{
        {node(-outer, weight_outer), node(-inner, weight_inner), node(inner, weight_inner),
         node(outer, weight_outer)}};
    double area = 0;
    const std::vector<double>& piece = breaks.sorted();
    for (std::size_t i = 0; i + 1 < piece.size(); ++i) {
        const double length = piece[i + 1] - piece[i];
        if (length <= 0) continue;
        for (const auto& [at, weight] : gauss) {
            area += weight * length * covered_length(local, piece[i] + at * length, spans);
        }
    }
    return area;
}

}  // namespace grainfield::simulate
