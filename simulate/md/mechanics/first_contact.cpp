#include "simulate/md/mechanics/first_contact.h"

// The order of these matters.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulate/md/mechanics/first_contact.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace grainfield::simulate::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, 4>;
using V = hn::Vec<Tag>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());
static_assert(lanes - 1 <= Candidates::spare);

struct Flights {
    V x, y, z, u, v, w, t;
};

// What the grains of `near` hold, one a lane.
HWY_INLINE Flights load(const Grain* grains, const std::int32_t* near) {
    const Tag d;
#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2
    // Two 4 × 4 transposes: x y z u and v w t.
    const auto at = [&](std::size_t k, std::size_t half) {
        const Grain& g = grains[static_cast<std::size_t>(near[k])];
        return hn::Load(d, (half == 0 ? &g.r.x : &g.v.y));
    };
    const V a0 = at(0, 0), a1 = at(1, 0), a2 = at(2, 0), a3 = at(3, 0);
    const V b0 = at(0, 1), b1 = at(1, 1), b2 = at(2, 1), b3 = at(3, 1);
    const V a01 = hn::InterleaveLower(d, a0, a1), a23 = hn::InterleaveLower(d, a2, a3);
    const V c01 = hn::InterleaveUpper(d, a0, a1), c23 = hn::InterleaveUpper(d, a2, a3);
    const V b01 = hn::InterleaveLower(d, b0, b1), b23 = hn::InterleaveLower(d, b2, b3);
    const V e01 = hn::InterleaveUpper(d, b0, b1), e23 = hn::InterleaveUpper(d, b2, b3);
    return {hn::ConcatLowerLower(d, a23, a01), hn::ConcatLowerLower(d, c23, c01),
            hn::ConcatUpperUpper(d, a23, a01), hn::ConcatUpperUpper(d, c23, c01),
            hn::ConcatLowerLower(d, b23, b01), hn::ConcatLowerLower(d, e23, e01),
            hn::ConcatUpperUpper(d, b23, b01)};
#else
    HWY_ALIGN double row[7][lanes];
    for (std::size_t k = 0; k < lanes; ++k) {
        const Grain& g = grains[static_cast<std::size_t>(near[k])];
        const double column[7] = {g.r.x, g.r.y, g.r.z, g.v.x, g.v.y, g.v.z, g.t};
        for (std::size_t c = 0; c < 7; ++c) row[c][k] = column[c];
    }
    return {hn::Load(d, row[0]), hn::Load(d, row[1]), hn::Load(d, row[2]), hn::Load(d, row[3]),
            hn::Load(d, row[4]), hn::Load(d, row[5]), hn::Load(d, row[6])};
#endif
}

// The operations of pair_time in its order, without fused ones: the same bits.
template <bool has_gravity, bool is_shifted>
HWY_INLINE Contact search(const Grain& grain, const Grain* grains, double gravity, double limit,
                          const Candidates& near) {
    const Tag d;
    const auto all = [&d](double x) { return hn::Set(d, x); };
    const V t1 = all(grain.t);
    const V half_g = all(0.5 * gravity);
    const V zero = hn::Zero(d);
    // Of each lane: the earliest contact so far, and the place of its candidate.
    V best = all(limit);
    V place_of_best = all(-1);
    V place = hn::Iota(d, 0);
    for (std::size_t k = 0; k < near.count; k += lanes) {
        const Flights g = load(grains, near.id.data() + k);
        const V start = hn::Max(t1, g.t);
        const V tau1 = hn::Sub(start, t1);
        const V tau2 = hn::Sub(start, g.t);
        const auto shifted = [&](V x, const double* shift) {
            return is_shifted ? hn::Add(x, hn::LoadU(d, shift + k)) : x;
        };
        const auto apart = [&](V r2, V v2, double r1, double v1) {
            return hn::Sub(hn::Add(r2, hn::Mul(v2, tau2)),
                           hn::Add(all(r1), hn::Mul(all(v1), tau1)));
        };
        const V x = shifted(apart(g.x, g.u, grain.r.x, grain.v.x), near.shift_x.data());
        const V y = shifted(apart(g.y, g.v, grain.r.y, grain.v.y), near.shift_y.data());
        const V u = hn::Sub(g.u, all(grain.v.x));
        const V v = hn::Sub(g.v, all(grain.v.y));
        V z;
        V w;
        if constexpr (has_gravity) {
            const auto height = [&](V r, V s, V tau) {
                return hn::Sub(hn::Add(r, hn::Mul(s, tau)), hn::Mul(hn::Mul(half_g, tau), tau));
            };
            z = hn::Sub(height(g.z, g.w, tau2), height(all(grain.r.z), all(grain.v.z), tau1));
            w = hn::Sub(hn::Sub(g.w, hn::Mul(all(gravity), tau2)),
                        hn::Sub(all(grain.v.z), hn::Mul(all(gravity), tau1)));
        } else {
            z = apart(g.z, g.w, grain.r.z, grain.v.z);
            w = hn::Sub(g.w, all(grain.v.z));
        }
        z = shifted(z, near.shift_z.data());
        const auto sum3 = [](V a, V b, V c) { return hn::Add(hn::Add(a, b), c); };
        const V b = sum3(hn::Mul(x, u), hn::Mul(y, v), hn::Mul(z, w));
        const V f = hn::Sub(sum3(hn::Mul(x, x), hn::Mul(y, y), hn::Mul(z, z)), all(1));
        const V v2 = sum3(hn::Mul(u, u), hn::Mul(v, v), hn::Mul(w, w));
        const V far = hn::Add(f, hn::Mul(hn::Mul(all(2), b), hn::Sub(all(limit), start)));
        const V discriminant = hn::Sub(hn::Mul(b, b), hn::Mul(v2, f));
        // Not a number where they miss each other: no contact then, as no comparison holds.
        const V later = hn::Add(start, hn::Div(f, hn::Sub(hn::Sqrt(discriminant), b)));
        const V time = hn::IfThenElse(hn::Le(f, zero), start, later);
        const auto is_first =
            hn::And(hn::And(hn::Lt(b, zero), hn::Le(far, zero)), hn::Lt(time, best));
        best = hn::IfThenElse(is_first, time, best);
        place_of_best = hn::IfThenElse(is_first, place, place_of_best);
        place = hn::Add(place, all(lanes));
    }
    // The first place of those that hold the least time.
    const V least = hn::MinOfLanes(d, best);
    const auto holds = hn::And(hn::Eq(best, least), hn::Ge(place_of_best, zero));
    const V no_place = all(static_cast<double>(Candidates::room));
    const double first =
        hn::GetLane(hn::MinOfLanes(d, hn::IfThenElse(holds, place_of_best, no_place)));
    if (first >= static_cast<double>(Candidates::room)) return {};
    const double time = hn::GetLane(least);
    return {time, near.id[static_cast<std::size_t>(first)]};
}

template <bool has_gravity>
HWY_INLINE Contact find(const Grain& grain, const Grain* grains, double gravity, double limit,
                        Candidates& near) {
    if (near.count == 0) return {};
    // The last lanes hold the last candidate once more.
    const std::size_t last = near.count - 1;
    for (std::size_t k = near.count; k < near.count + lanes - 1; ++k) {
        near.id[k] = near.id[last];
        if (!near.is_shifted) continue;
        near.shift_x[k] = near.shift_x[last];
        near.shift_y[k] = near.shift_y[last];
        near.shift_z[k] = near.shift_z[last];
    }
    return near.is_shifted ? search<has_gravity, true>(grain, grains, gravity, limit, near)
                           : search<has_gravity, false>(grain, grains, gravity, limit, near);
}

Contact first_contact_plain(const Grain& grain, const Grain* grains, double gravity, double limit,
                            Candidates& near) {
    return find<false>(grain, grains, gravity, limit, near);
}

Contact first_contact_gravity(const Grain& grain, const Grain* grains, double gravity, double limit,
                              Candidates& near) {
    return find<true>(grain, grains, gravity, limit, near);
}

}  // namespace grainfield::simulate::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::simulate {

HWY_EXPORT(first_contact_plain);
HWY_EXPORT(first_contact_gravity);

template <>
ContactSearch contact_search<false>() {
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return HWY_DYNAMIC_DISPATCH(first_contact_plain);
}

template <>
ContactSearch contact_search<true>() {
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return HWY_DYNAMIC_DISPATCH(first_contact_gravity);
}

}  // namespace grainfield::simulate
#endif
