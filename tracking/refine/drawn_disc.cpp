#include "tracking/refine/drawn_disc.h"

#include <algorithm>

#include "core/support/huge_pages.h"
#include "tracking/refine/computed_disc.h"
#include "tracking/refine/disc_templates.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/refine/drawn_disc.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tracking/refine/stencil_view-inl.h"

HWY_BEFORE_NAMESPACE();
namespace grainfield::tracking::HWY_NAMESPACE {

double lift_stencil(const StencilPieces& s, const DrawnPieces& to) {
    Vector change = hn::Zero(kTag);
    for_each_vector(s, 0, 0, [&](Vector, Vector, std::ptrdiff_t offset, std::size_t at) HWY_ATTR {
        const Vector old = hn::LoadU(kTag, s.transmission + offset);
        const Vector now = hn::Mul(old, reciprocal(load_half(s.kept + at)));
        hn::StoreU(now, kTag, to.transmission + offset);
        change = hn::Add(change, change_of(hn::LoadU(kTag, s.darkness + offset), old, now));
    });
    return sum(change);
}

double explained_stencil(const StencilPieces& s) {
    Vector change = hn::Zero(kTag);
    for_each_vector(s, 0, 0, [&](Vector, Vector, std::ptrdiff_t offset, std::size_t at) HWY_ATTR {
        const Vector old = hn::LoadU(kTag, s.transmission + offset);
        const Vector now = hn::Mul(old, reciprocal(load_half(s.kept + at)));
        change = hn::Add(change, change_of(hn::LoadU(kTag, s.darkness + offset), old, now));
    });
    return sum(change);
}

void local_misfit_stencil(const StencilPieces& s, const DiscTerms& disc, float x, float y,
                          double* sums) {
    Vector misfit = hn::Zero(kTag);
    Vector pixels = misfit;
    Vector at_edge = misfit;
    Vector edge = misfit;
    Vector edge2 = misfit;
    const Vector one = hn::Set(kTag, 1.0F);
    const Vector reach2 = hn::Set(kTag, disc.reach2);
    for_each_vector(
        s, x, y, [&](Vector dx, Vector dy, std::ptrdiff_t offset, std::size_t at) HWY_ATTR {
            const Vector transmission = hn::LoadU(kTag, s.transmission + offset);
            // Where nothing is looked at, it is 0 and there is no residual.
            const auto is_visible = hn::Gt(transmission, hn::Zero(kTag));
            const auto is_near = hn::Le(hn::MulAdd(dx, dx, hn::Mul(dy, dy)), reach2);
            const Vector residual = hn::IfThenElseZero(
                is_near, residual_of(hn::LoadU(kTag, s.darkness + offset), transmission));
            const Vector square = hn::Mul(residual, residual);
            // ∂t/∂r is as t (1 − t) at the usual edge, and T/t what the other discs leave.
            const Vector slope = hn::Mul(transmission, hn::Sub(one, load_half(s.kept + at)));
            const Vector weight = hn::IfThenElseZero(is_near, hn::Mul(slope, slope));
            misfit = hn::Add(misfit, square);
            at_edge = hn::MulAdd(weight, square, at_edge);
            edge = hn::Add(edge, weight);
            edge2 = hn::MulAdd(weight, weight, edge2);
            pixels = hn::Add(pixels, hn::IfThenElseZero(hn::And(is_near, is_visible), one));
        });
    sums[0] = sum(misfit);
    sums[1] = sum(pixels);
    sums[2] = sum(at_edge);
    sums[3] = sum(edge);
    sums[4] = sum(edge2);
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {

HWY_EXPORT(lift_stencil);
HWY_EXPORT(explained_stencil);
HWY_EXPORT(local_misfit_stencil);

void fetch(const ConstStencilView& view) {
    constexpr std::ptrdiff_t kLine = 16;  // floats
    for (const DiscStencil::Row& row : view.stencil.rows()) {
        const int x = view.anchor.x + row.first;
        const float* d = view.darkness.row(view.anchor.y + row.dy) + x;
        const float* t = view.transmission.row(view.anchor.y + row.dy) + x;
        for (std::ptrdiff_t i = 0; i < row.count; i += kLine) {
            fetch_line(d + i);
            fetch_line(t + i);
        }
    }
    if (view.has_shape()) return;
    const auto* kept = reinterpret_cast<const char*>(view.own);
    for (std::size_t i = 0; i < view.stencil.size() * sizeof(HalfFloat); i += 64) {
        fetch_line(kept + i);
    }
}

double lift(const StencilView& view) {
    return HWY_DYNAMIC_DISPATCH(lift_stencil)({view, view.stencil.pieces()}, DrawnPieces(view));
}

double explained(const ConstStencilView& view) {
    return HWY_DYNAMIC_DISPATCH(explained_stencil)({view, view.stencil.pieces()});
}

NormalEquations linearise(const ConstStencilView& view, Vec2 centre) {
    return view.has_shape() ? linearise_template(view) : linearise_computed(view, centre);
}

LocalMisfit local_misfit(const ConstStencilView& view, Vec2 centre) {
    const FromAnchor at(centre, view);
    double sums[5] = {};
    HWY_DYNAMIC_DISPATCH(local_misfit_stencil)
    ({view, view.stencil.pieces()}, view.stencil.terms(), at.x, at.y, sums);
    return {sums[0], sums[1], sums[2], sums[3], sums[4]};
}

CrossBlock coupling(const ConstStencilView& a, Vec2 centre_a, const ConstStencilView& b,
                    Vec2 centre_b) {
    return a.has_shape() && b.has_shape() ? couple_templates(a, b)
                                          : couple_computed(a, centre_a, b, centre_b);
}

}  // namespace grainfield::tracking
#endif
