#include "analysis/geometry/neighbours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/geometry/point_tree.h"

namespace grainfield::analysis {
namespace {

constexpr double points_per_cell = 1.6;
constexpr int most_cells_per_axis = 1 << 14;
constexpr double crowded = 64;  // points that share a cell with a point, on average

struct Extent {
    double low = 0;
    double high = 0;
};

Extent extent(std::span<const Vec2> points, double Vec2::*axis) {
    if (points.empty()) return {};
    Extent e{points[0].*axis, points[0].*axis};
    for (const Vec2& p : points) {
        e.low = std::min(e.low, p.*axis);
        e.high = std::max(e.high, p.*axis);
    }
    return e;
}

constexpr std::size_t most_nearest = 16;

int wrapped(int cell, int cells) {
    cell %= cells;
    return cell < 0 ? cell + cells : cell;
}

}  // namespace

int CellList::Axis::cell_of(double x) const {
    // Truncation is floor here: points lie inside, but for the rounding that the clamp catches.
    return static_cast<int>(std::clamp((x - origin) * cells_per_length, 0.0, cells - 1.0));
}

CellList::CellList(std::span<const Vec2> points, const Box& box) : box_(box) {
    const std::size_t n = points.size();
    const auto set_axis = [&](Axis& axis, double Vec2::*member, Boundary boundary) {
        axis.periodic = boundary == Boundary::periodic;
        const Extent e = extent(points, member);
        axis.origin = axis.periodic ? box.origin.*member : e.low;
        axis.length = axis.periodic ? box.length.*member : e.high - e.low;
    };
    set_axis(x_, &Vec2::x, box.boundary[0]);
    set_axis(y_, &Vec2::y, box.boundary[1]);
    // A pattern on a line still gets about points_per_cell points a cell.
    const double target = std::max(1.0, static_cast<double>(n) / points_per_cell);
    const double width = std::max(std::sqrt(x_.length * y_.length / target),
                                  std::max(x_.length, y_.length) / target);
    for (Axis* axis : {&x_, &y_}) {
        const double cells = width > 0 ? std::floor(axis->length / width) : 1;
        axis->cells = static_cast<int>(std::clamp(cells, 1.0, double{most_cells_per_axis}));
        axis->width = axis->length > 0 ? axis->length / axis->cells : 1;
        axis->cells_per_length = 1 / axis->width;
    }

    const auto cells = static_cast<std::size_t>(x_.cells) * static_cast<std::size_t>(y_.cells);
    std::vector<int> cell(n);
    first_.assign(cells + 1, 0);
    for (std::size_t i = 0; i < n; ++i) {
        cell[i] = y_.cell_of(points[i].y) * x_.cells + x_.cell_of(points[i].x);
        ++first_[static_cast<std::size_t>(cell[i]) + 1];
    }
    double shared = 0;
    for (int count : first_) shared += static_cast<double>(count) * count;
    if (shared > crowded * static_cast<double>(n)) {
        tree_ = std::make_shared<const PointTree>(points, box);
    }
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    std::vector<int> next(first_.begin(), first_.end() - 1);
    at_x_.resize(n);
    at_y_.resize(n);
    index_.resize(n);
    place_.resize(n);
    for (std::size_t i = 0; i < n; ++i) {
        const int at = next[static_cast<std::size_t>(cell[i])]++;
        at_x_[static_cast<std::size_t>(at)] = points[i].x;
        at_y_[static_cast<std::size_t>(at)] = points[i].y;
        index_[static_cast<std::size_t>(at)] = static_cast<int>(i);
        place_[i] = at;
    }
}

// Appends the points at places first … last − 1 that do not coincide with the centre.
void CellList::take(int first, int last, Vec2 centre, NeighbourList& out) const {
    Neighbour* room = out.room(static_cast<std::size_t>(last - first));
    std::size_t count = 0;
    for (auto at = static_cast<std::size_t>(first); at < static_cast<std::size_t>(last); ++at) {
        const Vec2 d = place(at) - centre;
        const double r2 = squared_norm(d);
        room[count] = {index_[at], d, r2};
        count += r2 > 0 ? 1U : 0U;
    }
    out.grow(count);
}

// Fills `out` with all points in the block of (2 rings + 1)² cells around the centre's cell and
// returns the distance within which no point is missed. Infinite if it holds all points.
double CellList::gather(Vec2 centre, int rings, NeighbourList& out) const {
    out.clear();
    const int cx = x_.cell_of(centre.x);
    const int cy = y_.cell_of(centre.y);
    double covered = std::numeric_limits<double>::infinity();
    const auto cover = [&](const Axis& axis, int cell, double at) {
        if (2 * rings + 1 >= axis.cells && axis.periodic) return;
        if (axis.periodic || cell - rings > 0) {
            covered = std::min(covered, at - axis.origin - (cell - rings) * axis.width);
        }
        if (axis.periodic || cell + rings < axis.cells - 1) {
            covered = std::min(covered, axis.origin + (cell + rings + 1) * axis.width - at);
        }
    };
    cover(x_, cx, centre.x);
    cover(y_, cy, centre.y);

    const auto range = [rings](const Axis& axis, int cell) {
        if (!axis.periodic) {
            return std::pair{std::max(0, cell - rings), std::min(axis.cells - 1, cell + rings)};
        }
        if (2 * rings + 1 >= axis.cells) return std::pair{0, axis.cells - 1};
        return std::pair{cell - rings, cell + rings};
    };
    const auto [x_low, x_high] = range(x_, cx);
    const auto [y_low, y_high] = range(y_, cy);
    const bool whole_row = x_.periodic && 2 * rings + 1 >= x_.cells;
    const bool whole_column = y_.periodic && 2 * rings + 1 >= y_.cells;
    const bool plain = x_low >= 0 && x_high < x_.cells && y_low >= 0 && y_high < y_.cells &&
                       !whole_row && !whole_column;
    for (int iy = y_low; iy <= y_high; ++iy) {
        const auto row =
            static_cast<std::size_t>(wrapped(iy, y_.cells)) * static_cast<std::size_t>(x_.cells);
        if (plain) {
            take(first_[row + static_cast<std::size_t>(x_low)],
                 first_[row + static_cast<std::size_t>(x_high) + 1], centre, out);
            continue;
        }
        for (int ix = x_low; ix <= x_high; ++ix) {
            const std::size_t cell = row + static_cast<std::size_t>(wrapped(ix, x_.cells));
            for (int at = first_[cell]; at < first_[cell + 1]; ++at) {
                const Vec2 d = box_.minimum_image(place(static_cast<std::size_t>(at)) - centre);
                const double r2 = squared_norm(d);
                if (r2 > 0) {
                    *out.room(1) = {index_[static_cast<std::size_t>(at)], d, r2};
                    out.grow(1);
                }
            }
        }
    }
    // The cell of a point on a cell's edge is decided by a rounded division: leave that much room.
    return covered * (1 - 1e-9);
}

CellList::Reach CellList::near_in_tree(Vec2 centre, int k, double factor,
                                       NeighbourList& out) const {
    tree_->nearest(centre, k, out);
    Reach reach;
    reach.count = static_cast<int>(out.size());
    if (out.empty()) return reach;
    for (const Neighbour& neighbour : out) reach.mean_first += std::sqrt(neighbour.r2);
    reach.mean_first /= reach.count;
    reach.nearest = std::sqrt(out.begin()->r2);
    const double limit = factor * reach.mean_first;
    if (limit * limit > (out.end() - 1)->r2) tree_->within(centre, limit * limit, out);
    return reach;
}

CellList::Reach CellList::near(int i, int k, double factor, NeighbourList& out) const {
    const int self = place_[static_cast<std::size_t>(i)];
    const Vec2 centre = place(static_cast<std::size_t>(self));
    if (tree_) return near_in_tree(centre, k, factor, out);
    std::array<double, most_nearest> smallest;
    for (int rings = 1;; rings *= 2) {
        const double covered = gather(centre, rings, out);
        const bool all = std::isinf(covered);
        const auto wanted = static_cast<std::size_t>(k);
        const std::size_t have = std::min(wanted, out.size());
        if (have < wanted && !all) continue;

        if (have == 4) {
            std::ranges::copy(smallest_r2<4>(out), smallest.begin());
        } else {
            smallest = smallest_r2<most_nearest>(out);
        }
        Reach reach;
        reach.count = static_cast<int>(have);
        if (have == 0) return reach;
        for (std::size_t j = 0; j < have; ++j) reach.mean_first += std::sqrt(smallest[j]);
        reach.mean_first /= static_cast<double>(have);
        reach.nearest = std::sqrt(smallest[0]);
        const double farthest = std::sqrt(smallest[have - 1]);
        if (!all && std::max(farthest, factor * reach.mean_first) > covered) continue;

        const double limit = factor * reach.mean_first;
        const double kth = smallest[have - 1];
        if (limit * limit > kth) {
            out.keep_if([=](const Neighbour& n) { return n.r2 < limit * limit; });
        } else {
            std::size_t ties = 0;  // how many at exactly the k-th distance belong to the k
            for (std::size_t j = 0; j < have; ++j) ties += smallest[j] == kth;
            out.keep_if([&](const Neighbour& n) {
                if (n.r2 != kth) return n.r2 < kth;
                return ties > 0 && ties-- > 0;
            });
        }
        return reach;
    }
}

void CellList::within(int i, double radius, NeighbourList& out) const {
    const int self = place_[static_cast<std::size_t>(i)];
    const Vec2 centre = place(static_cast<std::size_t>(self));
    if (tree_) return tree_->within(centre, radius * radius, out);
    // As many rings of cells as the radius spans; what they cover may be less by a rounding.
    const double spanned = std::ceil(radius / std::min(x_.width, y_.width));
    int rings = std::max(1, static_cast<int>(std::min<double>(spanned, x_.cells + y_.cells)));
    while (gather(centre, rings, out) < radius) ++rings;
    out.keep_if([radius](const Neighbour& n) { return n.r2 < radius * radius; });
}

}  // namespace grainfield::analysis
