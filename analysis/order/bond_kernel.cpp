#include "analysis/order/bond_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>

// The order of these matters.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/order/bond_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace grainfield::analysis::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, 4>;
using V = hn::Vec<Tag>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());

// The points of 3 × 3 cells, padded to whole vectors by points far away.
struct Candidates {
    HWY_ALIGN double x[most_candidates + 4];
    HWY_ALIGN double y[most_candidates + 4];
    HWY_ALIGN double r2[most_candidates + 4];
    std::array<int, 3> first{};  // place in cell order of each row's candidates
    std::array<int, 3> count{};
    std::size_t size = 0;
};

HWY_INLINE void order(V& low, V& high) {
    const V smaller = hn::Min(low, high);
    high = hn::Max(low, high);
    low = smaller;
}

// Lane by lane the four smallest of two ascending fours; they rise and fall once.
HWY_MAYBE_UNUSED void merge(std::array<V, 4>& s, const std::array<V, 4>& other) {
    for (std::size_t i = 0; i < 4; ++i) s[i] = hn::Min(s[i], other[3 - i]);
}

// The four smallest r², ascending.
HWY_INLINE std::array<double, 4> four_smallest(const Candidates& candidates) {
    const Tag d;
    const V infinite = hn::Set(d, std::numeric_limits<double>::infinity());
    std::array<V, 4> s{infinite, infinite, infinite, infinite};
    for (std::size_t j = 0; j < candidates.size; j += lanes) {
        V r2 = hn::Load(d, candidates.r2 + j);
        for (V& kept : s) order(kept, r2);
    }
#if HWY_TARGET != HWY_SCALAR
    std::array<V, 4> other;
    if constexpr (lanes == 4) {
        for (std::size_t i = 0; i < 4; ++i) other[i] = hn::ConcatLowerUpper(d, s[i], s[i]);
        merge(s, other);
        order(s[0], s[2]);
        order(s[1], s[3]);
        order(s[0], s[1]);
        order(s[2], s[3]);
    }
    for (std::size_t i = 0; i < 4; ++i) other[i] = hn::Reverse2(d, s[i]);
    merge(s, other);
#endif
    std::array<double, 4> four{hn::GetLane(s[0]), hn::GetLane(s[1]), hn::GetLane(s[2]),
                               hn::GetLane(s[3])};
    const auto sort = [&](std::size_t a, std::size_t b) {
        const double low = std::min(four[a], four[b]);
        four[b] = std::max(four[a], four[b]);
        four[a] = low;
    };
    sort(0, 2);
    sort(1, 3);
    sort(0, 1);
    sort(2, 3);
    sort(1, 2);
    return four;
}

// (x + iy)^k/r^k
struct Power {
    V re, im;
};

HWY_INLINE Power fourth(V x, V y, V r2) {
    const V a = hn::Sub(hn::Mul(x, x), hn::Mul(y, y));
    const V b = hn::Mul(hn::Add(x, x), y);
    const V scale = hn::Div(hn::Set(Tag(), 1.0), hn::Mul(r2, r2));
    return {hn::Mul(hn::Sub(hn::Mul(a, a), hn::Mul(b, b)), scale),
            hn::Mul(hn::Mul(hn::Add(a, a), b), scale)};
}

HWY_INLINE Power any(V x, V y, V r2, int k) {
    const V inverse = hn::Div(hn::Set(Tag(), 1.0), hn::Sqrt(r2));
    V re = hn::Mul(x, inverse);
    V im = hn::Mul(y, inverse);
    Power power{hn::Set(Tag(), 1.0), hn::Zero(Tag())};
    for (int left = k; left > 0; left /= 2) {
        if (left % 2 == 1) {
            power = {hn::Sub(hn::Mul(power.re, re), hn::Mul(power.im, im)),
                     hn::Add(hn::Mul(power.re, im), hn::Mul(power.im, re))};
        }
        const V squared = hn::Sub(hn::Mul(re, re), hn::Mul(im, im));
        im = hn::Mul(hn::Add(re, re), im);
        re = squared;
    }
    return power;
}

struct Sum {
    double re = 0, im = 0;
    std::uint64_t mask = 0;  // the candidates that are neighbours
};

// Over the candidates with r² below the limit.
template <bool is_fourth>
HWY_INLINE Sum sum_below(const Candidates& candidates, double px, double py, double limit2, int k) {
    const Tag d;
    const V x0 = hn::Set(d, px);
    const V y0 = hn::Set(d, py);
    const V limit = hn::Set(d, limit2);
    V re = hn::Zero(d);
    V im = hn::Zero(d);
    Sum sum;
    for (std::size_t j = 0; j < candidates.size; j += lanes) {
        const V r2 = hn::Load(d, candidates.r2 + j);
        const auto inside = hn::Lt(r2, limit);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, inside, bits);
        sum.mask |= std::uint64_t{bits[0]} << j;
        const V x = hn::Sub(hn::Load(d, candidates.x + j), x0);
        const V y = hn::Sub(hn::Load(d, candidates.y + j), y0);
        const Power power = is_fourth ? fourth(x, y, r2) : any(x, y, r2, k);
        re = hn::Add(re, hn::IfThenElseZero(inside, power.re));
        im = hn::Add(im, hn::IfThenElseZero(inside, power.im));
    }
    sum.re = hn::GetLane(hn::SumOfLanes(d, re));
    sum.im = hn::GetLane(hn::SumOfLanes(d, im));
    return sum;
}

// Distances of the candidates from a point; what coincides with it, and the padding, is infinitely
// far.
HWY_INLINE void set_distances(Candidates& candidates, double px, double py) {
    const Tag d;
    const V x0 = hn::Set(d, px);
    const V y0 = hn::Set(d, py);
    const V infinite = hn::Set(d, std::numeric_limits<double>::infinity());
    for (std::size_t j = 0; j < candidates.size; j += lanes) {
        const V x = hn::Sub(hn::Load(d, candidates.x + j), x0);
        const V y = hn::Sub(hn::Load(d, candidates.y + j), y0);
        const V r2 = hn::Add(hn::Mul(x, x), hn::Mul(y, y));
        hn::Store(hn::IfThenElse(hn::Gt(r2, hn::Zero(d)), r2, infinite), d, candidates.r2 + j);
    }
}

// False if there are too many.
HWY_INLINE bool collect(const CellList::View& cells, int column, int row, Candidates& candidates) {
    const int left = std::max(column - 1, 0);
    const int right = std::min(column + 1, cells.x.cells - 1);
    std::size_t size = 0;
    for (int r = 0; r < 3; ++r) {
        const auto at = static_cast<std::size_t>(r);
        const int y = row - 1 + r;
        candidates.count[at] = 0;
        if (y < 0 || y >= cells.y.cells) continue;
        const auto base = static_cast<std::ptrdiff_t>(y) * cells.x.cells;
        const int first = cells.first[base + left];
        const int count = cells.first[base + right + 1] - first;
        if (size + static_cast<std::size_t>(count) > most_candidates) return false;
        candidates.first[at] = first;
        candidates.count[at] = count;
        for (int j = 0; j < count; ++j, ++size) {
            candidates.x[size] = cells.at_x[first + j];
            candidates.y[size] = cells.at_y[first + j];
        }
    }
    for (; size % lanes != 0; ++size) candidates.x[size] = candidates.y[size] = 1e200;
    candidates.size = size;
    return true;
}

// How far around (px, py) the 3 × 3 cells hold everything.
HWY_INLINE double covered(const CellList::View& cells, int column, int row, double px, double py) {
    double far = std::numeric_limits<double>::infinity();
    const auto cover = [&far](const CellList::Axis& axis, int cell, double at) {
        if (axis.periodic || cell > 1)
            far = std::min(far, at - axis.origin - (cell - 1) * axis.width);
        if (axis.periodic || cell < axis.cells - 2)
            far = std::min(far, axis.origin + (cell + 2) * axis.width - at);
    };
    cover(cells.x, column, px);
    cover(cells.y, row, py);
    return far * (1 - 1e-9);  // as CellList::gather
}

// False if the candidates do not decide.
template <bool is_fourth>
HWY_INLINE bool set_point(const CellList::View& cells, const BondOrderOptions& rule,
                          Candidates& candidates, int place, double reach,
                          BondKernelOutput& output) {
    const double px = cells.at_x[place];
    const double py = cells.at_y[place];
    set_distances(candidates, px, py);
    const std::array<double, 4> four = four_smallest(candidates);
    if (!(four[3] < std::numeric_limits<double>::infinity())) return false;
    HWY_ALIGN double root[4];
    for (std::size_t i = 0; i < 4; i += lanes) {
        hn::Store(hn::Sqrt(hn::LoadU(Tag(), four.data() + i)), Tag(), root + i);
    }
    const double mean = (root[0] + root[1] + root[2] + root[3]) / 4;
    const double farthest = root[3];
    double limit2 = rule.cutoff * rule.cutoff;
    double needed = std::max(farthest, rule.cutoff);
    if (rule.rule == NeighbourRule::near_four) {
        limit2 = rule.factor * mean * rule.factor * mean;
        needed = std::max(farthest, rule.factor * mean);
    } else if (rule.rule == NeighbourRule::four_nearest) {
        limit2 = std::nextafter(four[3], std::numeric_limits<double>::infinity());
        needed = farthest;
    }
    if (!(needed <= reach)) return false;
    const Sum sum = sum_below<is_fourth>(candidates, px, py, limit2, rule.symmetry);
    const int count = std::popcount(sum.mask);
    if (rule.rule == NeighbourRule::four_nearest && count != 4) return false;

    const auto at = static_cast<std::size_t>(cells.index[place]);
    output.nearest[at] = root[0];
    output.mean_four[at] = mean;
    output.first[at] = output.listed;
    output.neighbours[at] = count;
    if (count > 0) {
        output.q[2 * at] = sum.re / count;
        output.q[2 * at + 1] = sum.im / count;
    }
    std::uint64_t mask = sum.mask;
    for (std::size_t r = 0; r < 3; ++r) {
        const int* index = cells.index + candidates.first[r];
        for (int j = 0; j < candidates.count[r]; ++j, mask >>= 1U) {
            output.neighbour[output.listed] = index[j];
            output.listed += mask & 1U;
        }
    }
    return true;
}

template <bool is_fourth>
HWY_INLINE void orders(const CellList::View& cells, const BondOrderOptions& rule, std::size_t from,
                       std::size_t to, BondKernelOutput& output) {
    Candidates candidates;
    const auto columns = static_cast<std::size_t>(cells.x.cells);
    for (std::size_t cell = from; cell < to; ++cell) {
        const int first = cells.first[cell];
        const int end = cells.first[cell + 1];
        if (first == end) continue;
        const int column = static_cast<int>(cell % columns);
        const int row = static_cast<int>(cell / columns);
        const bool is_wrapped =
            (cells.x.periodic && (column == 0 || column == cells.x.cells - 1)) ||
            (cells.y.periodic && (row == 0 || row == cells.y.cells - 1));
        const bool is_decided = !is_wrapped && collect(cells, column, row, candidates);
        for (int place = first; place < end; ++place) {
            if (is_decided &&
                set_point<is_fourth>(
                    cells, rule, candidates, place,
                    covered(cells, column, row, cells.at_x[place], cells.at_y[place]), output)) {
                continue;
            }
            output.left[output.left_count++] = cells.index[place];
        }
    }
}

void orders_of(const CellList::View& cells, const BondOrderOptions& rule, std::size_t from,
               std::size_t to, BondKernelOutput& output) {
    rule.symmetry == 4 ? orders<true>(cells, rule, from, to, output)
                       : orders<false>(cells, rule, from, to, output);
}

}  // namespace grainfield::analysis::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace grainfield::analysis {

HWY_EXPORT(orders_of);

void bond_orders(const CellList::View& cells, const BondOrderOptions& options, std::size_t from,
                 std::size_t to, BondKernelOutput& output) {
    HWY_DYNAMIC_DISPATCH(orders_of)(cells, options, from, to, output);
}

}  // namespace grainfield::analysis

#endif  // HWY_ONCE
