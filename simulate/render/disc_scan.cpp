#include "simulate/render/disc_scan.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace grainfield::simulate {

namespace {

double primitive(double t, double half_chord, double radius) {
    return 0.5 * (t * half_chord + radius * radius * std::asin(std::clamp(t / radius, -1.0, 1.0)));
}

int floor_to_int(double x) {
    return static_cast<int>(std::floor(x));
}

}  // namespace

bool DiscScan::prepare(const Disc& disc, int width, int y_first, int y_end) {
    disc_ = disc;
    const double radius = disc.radius;
    const auto [cx, cy] = disc.centre;
    if (!(radius > 0) || cx + radius < -0.5 || cx - radius > width || cy + radius < y_first - 0.5 ||
        cy - radius > y_end) {
        return false;
    }
    left_ = std::max(0, floor_to_int(cx - radius + 0.5));
    first_ = left_;
    end_ = std::min(width, floor_to_int(cx + radius + 0.5) + 1);
    top_ = std::max(y_first, floor_to_int(cy - radius + 0.5));
    bottom_ = std::min(y_end, floor_to_int(cy + radius + 0.5) + 1);
    if (first_ >= end_ || top_ >= bottom_) return false;

    const int borders = end_ - left_ + 1;
    columns_.resize(static_cast<std::size_t>(borders));
    for (std::size_t j = 0; j < columns_.size(); ++j) {
        const double u = left_ - 0.5 + static_cast<double>(j) - cx;
        const double clipped = std::min(std::abs(u), radius);
        const double k = std::sqrt(radius * radius - clipped * clipped);
        columns_[j] = {clipped, k, primitive(k, clipped, radius), u < 0 ? -1.0 : 1.0};
    }
    row_origin_ = top_;
    const int row_borders = bottom_ - top_ + 1;
    rows_.resize(static_cast<std::size_t>(row_borders));
    for (std::size_t j = 0; j < rows_.size(); ++j) {
        const double t = std::clamp(top_ - 0.5 + static_cast<double>(j) - cy, -radius, radius);
        const double half_chord = std::sqrt(radius * radius - t * t);
        rows_[j] = {t, half_chord, primitive(t, half_chord, radius)};
    }
    return true;
}

DiscScan::Row DiscScan::row_at(int y) const {
    const auto index = static_cast<std::size_t>(y - row_origin_);
    const RowBorder& above = rows_[index];
    const RowBorder& below = rows_[index + 1];
    Row row{above.t, below.t, above.h, below.h, 0, 0, 0, 0};
    const bool holds_centre = above.t < 0 && below.t > 0;
    const double widest =
        holds_centre ? disc_.radius : std::max(above.half_chord, below.half_chord);
    // Where the row sticks out of the disc, a border was clipped and its chord is zero.
    const double narrowest = std::min(above.half_chord, below.half_chord);
    const double x = disc_.centre.x;
    row.first = std::max(first_, floor_to_int(x - widest + 0.5));
    row.end = std::min(end_, floor_to_int(x + widest + 0.5) + 1);
    row.full_first = std::max(first_, static_cast<int>(std::ceil(x - narrowest + 0.5)));
    row.full_end = std::min(end_, floor_to_int(x + narrowest - 0.5) + 1);
    row.first = std::min(row.first, row.end);
    if (row.full_first < row.full_end) {
        row.full_first = std::clamp(row.full_first, row.first, row.end);
        row.full_end = std::clamp(row.full_end, row.full_first, row.end);
    }
    return row;
}

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

// Whether two circles cross within the pixel at the origin.
bool cross_within(const Disc& a, const Disc& b) {
    const Vec2 d = b.centre - a.centre;
    const double d2 = squared_norm(d);
    if (d2 == 0) return true;  // the same circle, or none of this matters
    const double along = 0.5 * (1 + (a.radius * a.radius - b.radius * b.radius) / d2);
    const double across2 = a.radius * a.radius / d2 - along * along;
    if (across2 < 0) return false;
    const double across = std::sqrt(across2);
    const Vec2 foot = a.centre + along * d;
    const Vec2 off{-across * d.y, across * d.x};
    const auto is_within = [](Vec2 p) { return std::abs(p.x) <= 0.5 && std::abs(p.y) <= 0.5; };
    return is_within(foot + off) || is_within(foot - off);
}

enum class Where { inside, outside, mixed };

// Where the points lie at which the circle of `disc` enters the pixel, seen from `other`.
Where side_of(const Disc& disc, const Disc& other) {
    int inside = 0;
    int points = 0;
    const auto consider = [&](Vec2 p) {
        ++points;
        inside += squared_norm(p - other.centre) < other.radius * other.radius;
    };
    for (const double border : {-0.5, 0.5}) {
        const double u = border - disc.centre.x;
        const double v = border - disc.centre.y;
        const double r2 = disc.radius * disc.radius;
        if (u * u < r2) {
            const double k = std::sqrt(r2 - u * u);
            if (std::abs(disc.centre.y - k) <= 0.5) consider({border, disc.centre.y - k});
            if (std::abs(disc.centre.y + k) <= 0.5) consider({border, disc.centre.y + k});
        }
        if (v * v < r2) {
            const double k = std::sqrt(r2 - v * v);
            if (std::abs(disc.centre.x - k) <= 0.5) consider({disc.centre.x - k, border});
            if (std::abs(disc.centre.x + k) <= 0.5) consider({disc.centre.x + k, border});
        }
    }
    if (points == 0 || (inside > 0 && inside < points)) return Where::mixed;
    return inside > 0 ? Where::inside : Where::outside;
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
    if (cross_within(first, second)) return std::nullopt;
    const Where of_first = side_of(first, second);
    const Where of_second = side_of(second, first);
    if (of_first == Where::mixed || of_second == Where::mixed) return std::nullopt;
    if (of_first == Where::outside && of_second == Where::outside) return area_a + area_b;
    if (of_first == Where::inside && of_second == Where::inside) return 1;
    return std::max(area_a, area_b);
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
