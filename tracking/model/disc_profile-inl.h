// The profile of a disc in vectors: included once per target by the kernels, hence no include guard
// of the usual kind.
#include <hwy/highway.h>

#include "tracking/model/disc_profile.h"
#include "tracking/model/padded_image.h"

#ifndef GRAINFIELD_DISC_TERMS
#define GRAINFIELD_DISC_TERMS
namespace grainfield::tracking {

/// What a kernel needs to know of a disc.
struct DiscTerms {
    float radius_over;     ///< (2/w) · D/2
    float two_over_width;  ///< 2/w [1/px]
    float reach2;          ///< [px²]
};

inline DiscTerms terms_of(const DiscProfile& disc) {
    const double reach = disc.reach();
    return {static_cast<float>(disc.diameter / disc.edge_width),
            static_cast<float>(2 / disc.edge_width), static_cast<float>(reach * reach)};
}

}  // namespace grainfield::tracking
#endif

#if defined(GRAINFIELD_DISC_PROFILE_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINFIELD_DISC_PROFILE_INL
#undef GRAINFIELD_DISC_PROFILE_INL
#else
#define GRAINFIELD_DISC_PROFILE_INL
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

struct Profile {
    Vector t;      // transmission of the disc
    Vector p;      // its darkness, zero beyond reach
    Vector r_inv;  // 1/r [1/px]
    hn::Mask<Tag> near;
};

HWY_INLINE Profile profile(Vector dx, Vector dy2, const DiscTerms& disc) {
    const Vector r2 = hn::MulAdd(dx, dx, dy2);
    const Vector r = hn::Sqrt(r2);
    // An estimate is enough for the direction of a step, and keeps r = 0 finite.
    const Vector r_inv = hn::ApproximateReciprocalSqrt(hn::Add(r2, hn::Set(kTag, 1e-12F)));
    const Vector limit = hn::Set(kTag, 2.0F * static_cast<float>(DiscProfile::kReachInWidths));
    Vector u2 =
        hn::NegMulAdd(r, hn::Set(kTag, disc.two_over_width), hn::Set(kTag, disc.radius_over));
    u2 = hn::Max(hn::Min(u2, limit), hn::Neg(limit));
    const Vector e = exp_small(u2);
    const Vector t = hn::Div(hn::Set(kTag, 1.0F), hn::Add(e, hn::Set(kTag, 1.0F)));
    const auto near = hn::Lt(r2, hn::Set(kTag, disc.reach2));
    return {hn::IfThenElse(near, t, hn::Set(kTag, 1.0F)), hn::IfThenElseZero(near, hn::Mul(e, t)),
            r_inv, near};
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
