// What kernels on the window of a disc share: included once per target, hence no include guard of
// the usual kind.
#include <hwy/highway.h>

#include "tracking/model/kernel_profile-inl.h"
#include "tracking/refine/stencil_view.h"

#ifndef GRAINFIELD_STENCIL_PIECES
#define GRAINFIELD_STENCIL_PIECES
namespace grainfield::tracking {

/// A view as the kernels want it: pointers to the anchor pixel.
struct StencilPieces {
    const DiscStencil::Piece* pieces;
    std::size_t n;
    const float* darkness;
    const float* transmission;
    const HalfFloat* kept;

    StencilPieces(const ConstStencilView& view, const std::vector<DiscStencil::Piece>& of)
        : pieces(of.data()),
          n(of.size()),
          darkness(view.darkness.row(view.anchor.y) + view.anchor.x),
          transmission(view.transmission.row(view.anchor.y) + view.anchor.x),
          kept(view.kept()) {}
};

/// What they write, where it is not const: the same pixels of T, and the values of the disc's own.
struct DrawnPieces {
    float* transmission;
    HalfFloat* own;

    explicit DrawnPieces(const StencilView& view)
        : transmission(view.transmission.row(view.anchor.y) + view.anchor.x), own(view.own) {}
};

/// A centre seen from the anchor [px].
struct FromAnchor {
    float x, y;
    FromAnchor(Vec2 centre, const ConstStencilView& view)
        : x(static_cast<float>(centre.x - view.anchor.x)),
          y(static_cast<float>(centre.y - view.anchor.y * view.stencil.spacing())) {}
};

}  // namespace grainfield::tracking
#endif

#if defined(GRAINFIELD_STENCIL_VIEW_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef GRAINFIELD_STENCIL_VIEW_INL
#undef GRAINFIELD_STENCIL_VIEW_INL
#else
#define GRAINFIELD_STENCIL_VIEW_INL
#endif

HWY_BEFORE_NAMESPACE();
namespace grainfield::tracking::HWY_NAMESPACE {

using StencilTag = hn::CappedTag<float, DiscStencil::kLanes>;
using Halves = hn::Rebind<std::uint16_t, StencilTag>;
using HalfFloats = hn::Rebind<hwy::float16_t, StencilTag>;

HWY_INLINE hn::Vec<StencilTag> load_half(const HalfFloat* from) {
    return hn::PromoteTo(StencilTag(), hn::BitCast(HalfFloats(), hn::LoadU(Halves(), from)));
}

/// Stores and returns the rounded value.
HWY_INLINE hn::Vec<StencilTag> store_half(hn::Vec<StencilTag> v, HalfFloat* to) {
    const auto half = hn::DemoteTo(HalfFloats(), v);
    hn::StoreU(hn::BitCast(Halves(), half), Halves(), to);
    return hn::PromoteTo(StencilTag(), half);
}

/// Calls body(dx, dy, offset, at) for every vector of the pieces: dx, dy from (x, y), which is the
/// centre seen from the anchor; its place in the images and among the kept values.
template <class Body>
HWY_INLINE void for_each_vector(const StencilPieces& s, float x, float y, Body&& body) {
    constexpr StencilTag tag;
    const std::size_t lanes = hn::Lanes(tag);
    const auto next = hn::Set(tag, static_cast<float>(lanes));
    const auto iota = hn::Sub(hn::Iota(tag, 0.0F), hn::Set(tag, x));
    const auto centre_y = hn::Set(tag, y);
    for (std::size_t j = 0; j < s.n; ++j) {
        const DiscStencil::Piece& piece = s.pieces[j];
        const auto dy = hn::Sub(hn::Set(tag, piece.dy), centre_y);
        auto dx = hn::Add(iota, hn::Set(tag, piece.dx));
        for (std::size_t i = 0; i < std::size_t{DiscStencil::kLanes}; i += lanes) {
            body(dx, dy, piece.offset + static_cast<std::ptrdiff_t>(i),
                 static_cast<std::size_t>(piece.at) + i);
            dx = hn::Add(dx, next);
        }
    }
}

/// The change of (I − 1 + T)² when T becomes `now`: a² − b² = (a − b)(a + b).
HWY_INLINE Vector change_of(Vector darkness, Vector before, Vector now) {
    const Vector b = residual_of(darkness, before);
    const Vector step = hn::Sub(now, before);
    return hn::Mul(step, hn::MulAdd(hn::Set(kTag, 2.0F), b, step));
}

/// What becomes NormalEquations.
struct NormalSums {
    Vector xx, xy, yy, bx, by, misfit;

    static HWY_INLINE NormalSums none() {
        const Vector zero = hn::Zero(kTag);
        return {zero, zero, zero, zero, zero, zero};
    }

    HWY_INLINE void add(Vector jx, Vector jy, Vector residual) {
        xx = hn::MulAdd(jx, jx, xx);
        xy = hn::MulAdd(jx, jy, xy);
        yy = hn::MulAdd(jy, jy, yy);
        bx = hn::MulAdd(jx, residual, bx);
        by = hn::MulAdd(jy, residual, by);
        misfit = hn::MulAdd(residual, residual, misfit);
    }
    HWY_INLINE void store(double* sums) const {
        const Vector all[] = {xx, xy, yy, bx, by, misfit};
        for (int i = 0; i < 6; ++i) sums[i] = sum(all[i]);
    }
};

/// What becomes a CrossBlock.
struct CrossSums {
    Vector xx, xy, yx, yy;

    static HWY_INLINE CrossSums none() {
        const Vector zero = hn::Zero(kTag);
        return {zero, zero, zero, zero};
    }

    HWY_INLINE void add(Vector from_a, Vector down_a, Vector from_b, Vector down_b) {
        xx = hn::MulAdd(from_a, from_b, xx);
        xy = hn::MulAdd(from_a, down_b, xy);
        yx = hn::MulAdd(down_a, from_b, yx);
        yy = hn::MulAdd(down_a, down_b, yy);
    }
    HWY_INLINE void store(double* sums) const {
        sums[0] = sum(xx);
        sums[1] = sum(xy);
        sums[2] = sum(yx);
        sums[3] = sum(yy);
    }
};

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();
#endif
