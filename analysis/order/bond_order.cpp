#include "analysis/order/bond_order.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>

#include "analysis/geometry/neighbours.h"
#include "analysis/geometry/triangulation.h"
#include "analysis/order/bond_kernel.h"

namespace grainfield::analysis {
namespace {

constexpr double undefined = std::numeric_limits<double>::quiet_NaN();

/// z^k / |z|^k without trigonometry; a square root only for odd k.
struct UnitPower {
    int k;

    std::complex<double> operator()(const Neighbour& neighbour) const {
        double re = neighbour.d.x;
        double im = neighbour.d.y;
        if (k == 4) {
            const double a = re * re - im * im;
            const double b = 2 * re * im;
            const double scale = 1 / (neighbour.r2 * neighbour.r2);
            return {(a * a - b * b) * scale, 2 * a * b * scale};
        }
        const double inverse = 1 / std::sqrt(neighbour.r2);
        re *= inverse;
        im *= inverse;
        double power_re = 1;
        double power_im = 0;
        for (int left = k; left > 0; left /= 2) {
            if (left % 2 == 1) {
                const double next = power_re * re - power_im * im;
                power_im = power_re * im + power_im * re;
                power_re = next;
            }
            const double squared = re * re - im * im;
            im = 2 * re * im;
            re = squared;
        }
        return {power_re, power_im};
    }
};

BondOrderField empty_field(std::size_t n) {
    BondOrderField field;
    field.q.assign(n, {undefined, undefined});
    field.neighbours.assign(n, 0);
    field.first.assign(n, 0);
    field.neighbour.reserve(6 * n + 32768);
    field.nearest.assign(n, undefined);
    field.mean_four.assign(n, undefined);
    return field;
}

template <class Range>
void set_order(BondOrderField& field, std::size_t i, const Range& neighbours, double limit2,
               const UnitPower& power) {
    double re = 0;
    double im = 0;
    int count = 0;
    field.first[i] = field.neighbour.size();
    for (const Neighbour& neighbour : neighbours) {
        if (neighbour.r2 >= limit2 || neighbour.r2 <= 0) continue;
        const std::complex<double> u = power(neighbour);
        re += u.real();
        im += u.imag();
        ++count;
        field.neighbour.push_back(neighbour.index);
    }
    field.neighbours[i] = count;
    if (count > 0) field.q[i] = {re / count, im / count};
}

constexpr double no_limit = std::numeric_limits<double>::infinity();

// One point by the general search.
void set_by_search(BondOrderField& field, const CellList& cells, int i,
                   const BondOrderOptions& options, NeighbourList& found) {
    const auto at = static_cast<std::size_t>(i);
    const double factor = options.rule == NeighbourRule::near_four ? options.factor : 0;
    const CellList::Reach reach = cells.near(i, 4, factor, found);
    if (reach.count > 0) field.nearest[at] = reach.nearest;
    if (reach.count == 4) field.mean_four[at] = reach.mean_first;
    double limit2 = no_limit;
    if (options.rule == NeighbourRule::fixed_cutoff) {
        cells.within(i, options.cutoff, found);
    } else if (options.rule == NeighbourRule::near_four) {
        limit2 = factor * reach.mean_first * factor * reach.mean_first;
    }
    set_order(field, at, found, limit2, UnitPower{options.symmetry});
}

BondOrderField by_cell_list(const Pattern& pattern, const BondOrderOptions& options) {
    BondOrderField field = empty_field(pattern.size());
    const CellList cells(pattern.position, pattern.box);
    const CellList::View view = cells.view();
    NeighbourList found;
    if (view.has_tree) {
        for (int i : cells.order()) set_by_search(field, cells, i, options, found);
        return field;
    }
    std::vector<int> left(pattern.size());
    BondKernelOutput output{reinterpret_cast<double*>(field.q.data()),
                            field.neighbours.data(),
                            field.first.data(),
                            field.nearest.data(),
                            field.mean_four.data(),
                            nullptr,
                            0,
                            left.data(),
                            0};
    constexpr std::size_t cells_at_once = 256;
    const auto all =
        static_cast<std::size_t>(view.x.cells) * static_cast<std::size_t>(view.y.cells);
    for (std::size_t from = 0; from < all; from += cells_at_once) {
        const std::size_t to = std::min(all, from + cells_at_once);
        const auto points = static_cast<std::size_t>(view.first[to] - view.first[from]);
        const std::size_t needed = output.listed + points * most_candidates;
        if (needed > field.neighbour.size()) {
            field.neighbour.resize(std::max(needed, field.neighbour.size() * 5 / 4));
        }
        output.neighbour = field.neighbour.data();
        bond_orders(view, options, from, to, output);
    }
    field.neighbour.resize(output.listed);
    left.resize(output.left_count);
    for (const int i : left) set_by_search(field, cells, i, options, found);
    return field;
}

// r̄4 of a particle whose neighbours are those of the triangulation; infinity without four of them.
double set_distances(BondOrderField& field, std::size_t i, std::span<const Neighbour> neighbours) {
    const std::array<double, 4> smallest = smallest_r2<4>(neighbours);
    const std::size_t have = std::min<std::size_t>(4, neighbours.size());
    double mean = 0;
    for (std::size_t j = 0; j < have; ++j) mean += std::sqrt(smallest[j]);
    mean /= static_cast<double>(have);
    field.nearest[i] = std::sqrt(smallest[0]);
    if (have == 4) field.mean_four[i] = mean;
    return mean;
}

// Σ_s l_s exp(i k θ_s)/Σ_s l_s, l_s the length of the edge to s.
void set_weighted_order(BondOrderField& field, std::size_t i, std::span<const Neighbour> neighbours,
                        std::span<const double> edges, double perimeter, const UnitPower& power) {
    std::complex<double> sum = 0;
    field.first[i] = field.neighbour.size();
    for (std::size_t s = 0; s < neighbours.size(); ++s) {
        if (!(edges[s] > 0) || neighbours[s].r2 <= 0) continue;
        sum += edges[s] * power(neighbours[s]);
        field.neighbour.push_back(neighbours[s].index);
        ++field.neighbours[i];
    }
    if (field.neighbours[i] > 0) field.q[i] = sum / perimeter;
}

BondOrderField by_triangulation(const Pattern& pattern, const BondOrderOptions& options) {
    BondOrderField field = empty_field(pattern.size());
    const bool weighs =
        options.rule == NeighbourRule::voronoi_edge || options.rule == NeighbourRule::edge_weighted;
    const Triangulation triangulation(
        pattern.position, pattern.box,
        weighs ? Triangulation::Edges::measured : Triangulation::Edges::none);
    const UnitPower power{options.symmetry};
    std::vector<Neighbour> kept;
    for (std::size_t i = 0; i < pattern.size(); ++i) {
        const auto neighbours = triangulation.neighbours(i);
        if (neighbours.empty()) continue;
        const auto edges = weighs ? triangulation.edges(i) : std::span<const double>();
        const double limit = options.factor * set_distances(field, i, neighbours);
        const double perimeter = std::accumulate(edges.begin(), edges.end(), 0.0);
        switch (options.rule) {
            case NeighbourRule::near_delaunay:
                set_order(field, i, neighbours, limit * limit, power);
                break;
            case NeighbourRule::voronoi_edge:
                kept.clear();
                for (std::size_t s = 0; s < neighbours.size(); ++s) {
                    if (edges[s] > options.edge * perimeter / 4) kept.push_back(neighbours[s]);
                }
                set_order(field, i, kept, no_limit, power);
                break;
            case NeighbourRule::edge_weighted:
                set_weighted_order(field, i, neighbours, edges, perimeter, power);
                break;
            default:
                set_order(field, i, neighbours, no_limit, power);
        }
    }
    return field;
}

}  // namespace

BondOrderField bond_order(const Pattern& pattern, const BondOrderOptions& options) {
    return needs_triangulation(options.rule) ? by_triangulation(pattern, options)
                                             : by_cell_list(pattern, options);
}

std::vector<double> abs_q4(const Snapshot& snapshot, double diameter,
                           const BondOrderOptions& options) {
    std::vector<double> result(snapshot.size(), std::numeric_limits<double>::quiet_NaN());
    const BondOrderField field = bond_order(pattern_of(snapshot, diameter), options);
    std::size_t next = 0;
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        const Vec2 p = snapshot.position[i];
        if (!is_finite({p.x / diameter, p.y / diameter})) continue;
        result[i] = std::abs(field.q[next++]);
    }
    return result;
}

}  // namespace grainfield::analysis
