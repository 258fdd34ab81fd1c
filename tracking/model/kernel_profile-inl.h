// The profile of a disc in vectors: included once per target by the kernels, hence no include guard
// of the usual kind.
#include <hwy/highway.h>

#include "tracking/model/kernel_profile.h"
#include "tracking/model/padded_image.h"

#if defined(GRAINFIELD_KERNEL_PROFILE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINFIELD_KERNEL_PROFILE_INL
#undef GRAINFIELD_KERNEL_PROFILE_INL
#else
#define GRAINFIELD_KERNEL_PROFILE_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace grainfield::tracking::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, 8>;
using Vector = hn::Vec<Tag>;
constexpr Tag kTag;

/// exp(x) for |x| ≤ 20, relative error < 3e-7: 2^k times a degree-6 polynomial on |f| ≤ ln2/2.
HWY_INLINE Vector exp_small(Vector x) {
    const hn::RebindToSigned<Tag> integers;
    const auto k = hn::NearestInt(hn::Mul(x, hn::Set(kTag, 1.44269504F)));
    const Vector f = hn::NegMulAdd(hn::ConvertTo(kTag, k), hn::Set(kTag, 0.693147181F), x);
    // Estrin's scheme: the chain of dependent operations is what costs time here.
    const Vector f2 = hn::Mul(f, f);
    const Vector low = hn::MulAdd(f, hn::Set(kTag, 1.0F / 6), hn::Set(kTag, 0.5F));
    const Vector high =
        hn::MulAdd(f2, hn::Set(kTag, 1.0F / 720),
                   hn::MulAdd(f, hn::Set(kTag, 1.0F / 120), hn::Set(kTag, 1.0F / 24)));
    const Vector tail = hn::MulAdd(f2, high, low);
    const Vector p = hn::MulAdd(f2, tail, hn::Add(f, hn::Set(kTag, 1.0F)));
    return hn::Mul(p, hn::BitCast(kTag, hn::ShiftLeft<23>(hn::Add(k, hn::Set(integers, 127)))));
}

/// The same to 5e-5.
HWY_INLINE Vector exp_rough(Vector x) {
    const hn::RebindToSigned<Tag> integers;
    const auto k = hn::NearestInt(hn::Mul(x, hn::Set(kTag, 1.44269504F)));
    const Vector f = hn::NegMulAdd(hn::ConvertTo(kTag, k), hn::Set(kTag, 0.693147181F), x);
    const Vector f2 = hn::Mul(f, f);
    const Vector high = hn::MulAdd(f2, hn::Set(kTag, 1.0F / 24),
                                   hn::MulAdd(f, hn::Set(kTag, 1.0F / 6), hn::Set(kTag, 0.5F)));
    const Vector p = hn::MulAdd(f2, high, hn::Add(f, hn::Set(kTag, 1.0F)));
    return hn::Mul(p, hn::BitCast(kTag, hn::ShiftLeft<23>(hn::Add(k, hn::Set(integers, 127)))));
}

/// 1/x to single precision: the processor's estimate and one step of Newton.
HWY_INLINE Vector reciprocal(Vector x) {
    const Vector y = hn::ApproximateReciprocal(x);
    return hn::Mul(y, hn::NegMulAdd(x, y, hn::Set(kTag, 2.0F)));
}

/// The tanh edge in closed form. In both structs dx, dy are distances from the centre, `kept` is t
/// as stored, and J = ∂M/∂(x, y) = gradient · (dx, dy).
struct TanhDisc {
    const DiscTerms& terms;

    HWY_INLINE Vector limited(Vector u) const {
        const Vector limit = hn::Set(kTag, 2.0F * static_cast<float>(TanhEdge::kReachInWidths));
        return hn::Max(hn::Min(u, limit), hn::Neg(limit));
    }
    /// t in single precision.
    HWY_INLINE Vector transmission(Vector dx, Vector dy2) const {
        const Vector r2 = hn::MulAdd(dx, dx, dy2);
        const Vector u = hn::NegMulAdd(hn::Sqrt(r2), hn::Set(kTag, terms.two_over_width),
                                       hn::Set(kTag, terms.radius_over));
        const Vector e = exp_small(limited(u));
        const Vector t = hn::Div(hn::Set(kTag, 1.0F), hn::Add(e, hn::Set(kTag, 1.0F)));
        return hn::IfThenElse(hn::Lt(r2, hn::Set(kTag, terms.reach2)), t, hn::Set(kTag, 1.0F));
    }
    /// t to the accuracy of a half float, 5e-4 of its value.
    HWY_INLINE Vector rough_transmission(Vector dx, Vector dy2) const {
        const Vector r2 = hn::MulAdd(dx, dx, dy2);
        const Vector floored = hn::Max(r2, hn::Set(kTag, 1e-6F));
        const Vector estimate = hn::ApproximateReciprocalSqrt(floored);
        // One step of Newton: r to 1e-6 px.
        const Vector half = hn::Mul(hn::Mul(floored, estimate), hn::Set(kTag, 0.5F));
        const Vector r_inv = hn::Mul(estimate, hn::NegMulAdd(half, estimate, hn::Set(kTag, 1.5F)));
        const Vector u = hn::NegMulAdd(hn::Mul(floored, r_inv), hn::Set(kTag, terms.two_over_width),
                                       hn::Set(kTag, terms.radius_over));
        const Vector t =
            hn::ApproximateReciprocal(hn::Add(exp_rough(limited(u)), hn::Set(kTag, 1.0F)));
        return hn::IfThenElse(hn::Lt(r2, hn::Set(kTag, terms.reach2)), t, hn::Set(kTag, 1.0F));
    }
    /// T (2/w) P/r. Beyond reach t is 1 and P is 0. An estimate of 1/r is enough for the direction
    /// of a step, and keeps r = 0 finite.
    HWY_INLINE Vector gradient(Vector scene, Vector kept, Vector r2) const {
        const Vector p = hn::Sub(hn::Set(kTag, 1.0F), kept);
        const Vector r_inv = hn::ApproximateReciprocalSqrt(hn::Add(r2, hn::Set(kTag, 1e-12F)));
        const Vector slope = hn::Set(kTag, terms.two_over_width);
        return hn::Mul(hn::Mul(scene, slope), hn::Mul(p, r_inv));
    }
    /// (2/w) P/r to single precision.
    HWY_INLINE Vector exact_gradient(Vector kept, Vector r2) const {
        const Vector p = hn::Sub(hn::Set(kTag, 1.0F), kept);
        return hn::Div(hn::Mul(hn::Set(kTag, terms.two_over_width), p),
                       hn::Sqrt(hn::Add(r2, hn::Set(kTag, 1e-12F))));
    }
    /// The product of two gradients. r2 is above zero.
    HWY_INLINE Vector gradients(Vector scene, Vector kept_a, Vector a2, Vector kept_b,
                                Vector b2) const {
        const Vector one = hn::Set(kTag, 1.0F);
        const Vector g = hn::Mul(scene, hn::Set(kTag, terms.two_over_width));
        const Vector pa = hn::Sub(one, kept_a);
        const Vector pb = hn::Sub(one, kept_b);
        const Vector r_inv =
            hn::Mul(hn::ApproximateReciprocalSqrt(a2), hn::ApproximateReciprocalSqrt(b2));
        return hn::Mul(hn::Mul(hn::Mul(g, g), hn::Mul(pa, pb)), r_inv);
    }
};

/// Any other profile, from its tables.
struct TabulatedDisc {
    const DiscTerms& terms;

    /// Linear between the values at both sides of r; beyond the table its last but one value.
    HWY_INLINE Vector value_at(const float* table, Vector r2) const {
        const hn::RebindToSigned<Tag> integers;
        const Vector place = hn::Min(hn::Mul(hn::Sqrt(r2), hn::Set(kTag, terms.per_pixel)),
                                     hn::Set(kTag, terms.last));
        const auto below = hn::ConvertTo(integers, place);
        const Vector share = hn::Sub(place, hn::ConvertTo(kTag, below));
        const Vector low = hn::GatherIndex(kTag, table, below);
        const Vector high = hn::GatherIndex(kTag, table, hn::Add(below, hn::Set(integers, 1)));
        return hn::MulAdd(share, hn::Sub(high, low), low);
    }
    HWY_INLINE Vector transmission(Vector dx, Vector dy2) const {
        const Vector r2 = hn::MulAdd(dx, dx, dy2);
        return hn::IfThenElse(hn::Lt(r2, hn::Set(kTag, terms.reach2)),
                              value_at(terms.transmission, r2), hn::Set(kTag, 1.0F));
    }
    HWY_INLINE Vector rough_transmission(Vector dx, Vector dy2) const {
        return transmission(dx, dy2);
    }
    HWY_INLINE Vector exact_gradient(Vector, Vector r2) const {
        return hn::IfThenElseZero(hn::Lt(r2, hn::Set(kTag, terms.reach2)),
                                  value_at(terms.gradient, r2));
    }
    HWY_INLINE Vector gradient(Vector scene, Vector kept, Vector r2) const {
        return hn::Mul(scene, exact_gradient(kept, r2));
    }
    HWY_INLINE Vector gradients(Vector scene, Vector kept_a, Vector a2, Vector kept_b,
                                Vector b2) const {
        return hn::Mul(gradient(scene, kept_a, a2), gradient(scene, kept_b, b2));
    }
};

/// kernel(disc) with the struct that the terms ask for.
template <class Kernel>
HWY_INLINE auto with_profile(const DiscTerms& terms, Kernel&& kernel) {
    if (terms.transmission == nullptr) return kernel(TanhDisc{terms});
    return kernel(TabulatedDisc{terms});
}

HWY_INLINE double sum(Vector v) {
    return static_cast<double>(hn::GetLane(hn::SumOfLanes(kTag, v)));
}

// Residual of a pixel: I − M = I − 1 + T.
HWY_INLINE Vector residual_of(Vector darkness, Vector transmission) {
    return hn::Add(hn::Sub(darkness, hn::Set(kTag, 1.0F)), transmission);
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
