#include "simulate/md/mechanics/pair_filter.h"

#include <bit>
#include <cstring>

// The order of these matters.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simulate/md/mechanics/pair_filter.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace grainfield::simulate::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, 4>;
using V = hn::Vec<Tag>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());

struct Flights {
    V x, y, z, u, v, w, t;
};

// What the grains of `near` hold, one a lane.
HWY_INLINE Flights load(const Grain* grains, const std::int32_t* near) {
    const Tag d;
#if HWY_TARGET == HWY_AVX2 || HWY_TARGET == HWY_AVX3 || HWY_TARGET == HWY_AVX3_DL
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
template <bool has_gravity>
std::size_t filter(const Grain& grain, const Grain* grains, const Vec3& shift, double gravity,
                   double limit, std::int32_t* near, std::size_t count) {
    const Tag d;
    const auto all = [&d](double x) { return hn::Set(d, x); };
    if (count == 0) return 0;
    for (std::size_t k = count; k < count + lanes - 1; ++k) near[k] = near[count - 1];
    const V t1 = all(grain.t);
    const V half_g = all(0.5 * gravity);
    std::size_t kept = 0;
    for (std::size_t k = 0; k < count; k += lanes) {
        const Flights g = load(grains, near + k);
        const V start = hn::Max(t1, g.t);
        const V tau1 = hn::Sub(start, t1);
        const V tau2 = hn::Sub(start, g.t);
        const auto place = [&](V r2, V v2, double r1, double v1, double s) {
            return hn::Add(
                hn::Sub(hn::Add(r2, hn::Mul(v2, tau2)), hn::Add(all(r1), hn::Mul(all(v1), tau1))),
                all(s));
        };
        const V x = place(g.x, g.u, grain.r.x, grain.v.x, shift.x);
        const V y = place(g.y, g.v, grain.r.y, grain.v.y, shift.y);
        const V u = hn::Sub(g.u, all(grain.v.x));
        const V v = hn::Sub(g.v, all(grain.v.y));
        V z;
        V w;
        if constexpr (has_gravity) {
            const auto height = [&](V r, V s, V tau) {
                return hn::Sub(hn::Add(r, hn::Mul(s, tau)), hn::Mul(hn::Mul(half_g, tau), tau));
            };
            z = hn::Add(
                hn::Sub(height(g.z, g.w, tau2), height(all(grain.r.z), all(grain.v.z), tau1)),
                all(shift.z));
            w = hn::Sub(hn::Sub(g.w, hn::Mul(all(gravity), tau2)),
                        hn::Sub(all(grain.v.z), hn::Mul(all(gravity), tau1)));
        } else {
            z = place(g.z, g.w, grain.r.z, grain.v.z, shift.z);
            w = hn::Sub(g.w, all(grain.v.z));
        }
        const auto sum3 = [](V a, V b, V c) { return hn::Add(hn::Add(a, b), c); };
        const V b = sum3(hn::Mul(x, u), hn::Mul(y, v), hn::Mul(z, w));
        const V f = hn::Sub(sum3(hn::Mul(x, x), hn::Mul(y, y), hn::Mul(z, z)), all(1));
        const V v2 = sum3(hn::Mul(u, u), hn::Mul(v, v), hn::Mul(w, w));
        const V far = hn::Add(f, hn::Mul(hn::Mul(all(2), b), hn::Sub(all(limit), start)));
        const V discriminant = hn::Sub(hn::Mul(b, b), hn::Mul(v2, f));
        const V zero = hn::Zero(d);
        const auto meets = hn::Or(hn::Le(f, zero), hn::Ge(discriminant, zero));
        const auto pass = hn::And(hn::And(hn::Lt(b, zero), hn::Le(far, zero)), meets);
        std::uint8_t bits[8] = {};
        hn::StoreMaskBits(d, pass, bits);
        unsigned left = bits[0];
        if (count - k < lanes) left &= (1U << (count - k)) - 1;
        for (; left != 0; left &= left - 1) {
            near[kept++] = near[k + static_cast<std::size_t>(std::countr_zero(left))];
        }
    }
    return kept;
}

std::size_t filter_plain(const Grain& grain, const Grain* grains, const Vec3& shift, double gravity,
                         double limit, std::int32_t* near, std::size_t count) {
    return filter<false>(grain, grains, shift, gravity, limit, near, count);
}

std::size_t filter_gravity(const Grain& grain, const Grain* grains, const Vec3& shift,
                           double gravity, double limit, std::int32_t* near, std::size_t count) {
    return filter<true>(grain, grains, shift, gravity, limit, near, count);
}

}  // namespace grainfield::simulate::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::simulate {

HWY_EXPORT(filter_plain);
HWY_EXPORT(filter_gravity);

template <>
PairFilter pair_filter<false>() {
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return HWY_DYNAMIC_DISPATCH(filter_plain);
}

template <>
PairFilter pair_filter<true>() {
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return HWY_DYNAMIC_DISPATCH(filter_gravity);
}

}  // namespace grainfield::simulate
#endif
