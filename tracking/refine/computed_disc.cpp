#include "tracking/refine/computed_disc.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/refine/computed_disc.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tracking/refine/stencil_view-inl.h"

#ifndef GRAINFIELD_SHARED_ROW
#define GRAINFIELD_SHARED_ROW
namespace grainfield::tracking {

/// A run of pixels in the windows of two discs; distances of the first one from either centre.
struct SharedRow {
    const float* transmission;
    const HalfFloat *a, *b;
    float ax, ay, bx, by;
    int count;
};

}  // namespace grainfield::tracking
#endif

HWY_BEFORE_NAMESPACE();
namespace grainfield::tracking::HWY_NAMESPACE {

/// T ← T · t. The change of the misfit asks for the darkness, hence the choice.
template <bool with_change, class Profile>
HWY_INLINE double draw_computed(const StencilPieces& s, const DrawnPieces& to, const Profile& disc,
                                float x, float y) {
    Vector change = hn::Zero(kTag);
    const Vector reach2 = hn::Set(kTag, disc.terms.reach2);
    for_each_vector(
        s, x, y, [&](Vector dx, Vector dy, std::ptrdiff_t offset, std::size_t at) HWY_ATTR {
            const Vector dy2 = hn::Mul(dy, dy);
            // The last vector of most rows is there for discs off the anchor only.
            if (hn::AllFalse(kTag, hn::Lt(hn::MulAdd(dx, dx, dy2), reach2))) {
                store_half(hn::Set(kTag, 1.0F), to.own + at);
                return;
            }
            const Vector t = store_half(disc.rough_transmission(dx, dy2), to.own + at);
            const Vector old = hn::LoadU(kTag, s.transmission + offset);
            const Vector now = hn::Mul(old, t);
            hn::StoreU(now, kTag, to.transmission + offset);
            if constexpr (with_change) {
                change = hn::Add(change, change_of(hn::LoadU(kTag, s.darkness + offset), old, now));
            }
        });
    return with_change ? sum(change) : 0;
}

double place_stencil(const StencilPieces& s, const DrawnPieces& to, const DiscTerms& terms, float x,
                     float y) {
    return with_profile(
        terms, [&](const auto& disc) HWY_ATTR { return draw_computed<true>(s, to, disc, x, y); });
}

void draw_stencil(const StencilPieces& s, const DrawnPieces& to, const DiscTerms& terms, float x,
                  float y) {
    with_profile(
        terms, [&](const auto& disc) HWY_ATTR { return draw_computed<false>(s, to, disc, x, y); });
}

template <class Profile>
HWY_INLINE void linearise_on(const StencilPieces& s, const Profile& disc, float x, float y,
                             double* sums) {
    NormalSums n = NormalSums::none();
    for_each_vector(
        s, x, y, [&](Vector dx, Vector dy, std::ptrdiff_t offset, std::size_t at) HWY_ATTR {
            const Vector transmission = hn::LoadU(kTag, s.transmission + offset);
            const Vector residual = residual_of(hn::LoadU(kTag, s.darkness + offset), transmission);
            const Vector r2 = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
            const Vector g = disc.gradient(transmission, load_half(s.kept + at), r2);
            const Vector jx = hn::Mul(g, dx);
            const Vector jy = hn::Mul(g, dy);
            n.add(jx, jy, residual);
        });
    n.store(sums);
}

void linearise_stencil(const StencilPieces& s, const DiscTerms& terms, float x, float y,
                       double* sums) {
    with_profile(terms, [&](const auto& disc) HWY_ATTR { linearise_on(s, disc, x, y, sums); });
}

template <class Profile>
HWY_INLINE void couple_on(const SharedRow* rows, int n, const Profile& disc, double* sums) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    const Vector iota = hn::Iota(kTag, 0.0F);
    const Vector floor = hn::Set(kTag, 1e-12F);
    CrossSums block = CrossSums::none();
    for (int j = 0; j < n; ++j) {
        const SharedRow& row = rows[j];
        const Vector ay = hn::Set(kTag, row.ay);
        const Vector by = hn::Set(kTag, row.by);
        for (int i = 0; i < row.count; i += lanes) {
            const auto at = static_cast<std::size_t>(i);
            const auto inside = hn::FirstN(kTag, static_cast<std::size_t>(row.count - i));
            const Vector ax = hn::Add(iota, hn::Set(kTag, row.ax + static_cast<float>(i)));
            const Vector bx = hn::Add(iota, hn::Set(kTag, row.bx + static_cast<float>(i)));
            const Vector ra = hn::MulAdd(ax, ax, hn::MulAdd(ay, ay, floor));
            const Vector rb = hn::MulAdd(bx, bx, hn::MulAdd(by, by, floor));
            const Vector all = disc.gradients(hn::LoadU(kTag, row.transmission + i),
                                              load_half(row.a + at), ra, load_half(row.b + at), rb);
            const Vector both = hn::IfThenElseZero(inside, all);
            const Vector from_a = hn::Mul(both, ax);
            const Vector down_a = hn::Mul(both, ay);
            block.add(from_a, down_a, bx, by);
        }
    }
    block.store(sums);
}

void couple_rows(const SharedRow* rows, int n, const DiscTerms& terms, double* sums) {
    with_profile(terms, [&](const auto& disc) HWY_ATTR { couple_on(rows, n, disc, sums); });
}

/// T ← T · t / t_before. Without a way back (null) the change is not summed either.
template <bool with_way_back, class Profile>
HWY_INLINE double shift_computed(const StencilPieces& s, const DrawnPieces& to, const Profile& disc,
                                 float x, float y, float* transmission_before,
                                 HalfFloat* kept_before) {
    Vector change = hn::Zero(kTag);
    for_each_vector(
        s, x, y, [&](Vector dx, Vector dy, std::ptrdiff_t offset, std::size_t at) HWY_ATTR {
            const Vector old = hn::LoadU(kTag, s.transmission + offset);
            const auto halves = hn::LoadU(Halves(), s.kept + at);
            if constexpr (with_way_back) {
                hn::StoreU(old, kTag, transmission_before + at);
                hn::StoreU(halves, Halves(), kept_before + at);
            }
            const Vector before = hn::PromoteTo(StencilTag(), hn::BitCast(HalfFloats(), halves));
            const Vector t = store_half(disc.rough_transmission(dx, hn::Mul(dy, dy)), to.own + at);
            const Vector now = hn::Mul(hn::Mul(old, t), reciprocal(before));
            hn::StoreU(now, kTag, to.transmission + offset);
            if constexpr (with_way_back) {
                change = hn::Add(change, change_of(hn::LoadU(kTag, s.darkness + offset), old, now));
            }
        });
    return with_way_back ? sum(change) : 0;
}

double shift_stencil(const StencilPieces& s, const DrawnPieces& to, const DiscTerms& terms, float x,
                     float y, float* transmission_before, HalfFloat* kept_before) {
    return with_profile(terms, [&](const auto& disc) HWY_ATTR {
        return shift_computed<true>(s, to, disc, x, y, transmission_before, kept_before);
    });
}

void redraw_stencil(const StencilPieces& s, const DrawnPieces& to, const DiscTerms& terms, float x,
                    float y) {
    with_profile(terms, [&](const auto& disc) HWY_ATTR {
        return shift_computed<false>(s, to, disc, x, y, nullptr, nullptr);
    });
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {

HWY_EXPORT(draw_stencil);
HWY_EXPORT(place_stencil);
HWY_EXPORT(linearise_stencil);
HWY_EXPORT(couple_rows);
HWY_EXPORT(shift_stencil);
HWY_EXPORT(redraw_stencil);

double place(const StencilView& view, Vec2 centre) {
    const FromAnchor at(centre, view);
    return HWY_DYNAMIC_DISPATCH(place_stencil)({view, view.stencil.pieces()}, DrawnPieces(view),
                                               view.stencil.terms(), at.x, at.y);
}

void draw(const StencilView& view, Vec2 centre) {
    const FromAnchor at(centre, view);
    HWY_DYNAMIC_DISPATCH(draw_stencil)
    ({view, view.stencil.pieces()}, DrawnPieces(view), view.stencil.terms(), at.x, at.y);
}

NormalEquations linearise_computed(const ConstStencilView& view, Vec2 centre) {
    const FromAnchor at(centre, view);
    double sums[6] = {};
    HWY_DYNAMIC_DISPATCH(linearise_stencil)
    ({view, view.stencil.edge_pieces()}, view.stencil.terms(), at.x, at.y, sums);
    return {sums[0], sums[1], sums[2], sums[3], sums[4], sums[5]};
}

CrossBlock couple_computed(const ConstStencilView& a, Vec2 centre_a, const ConstStencilView& b,
                           Vec2 centre_b) {
    const std::vector<DiscStencil::Row>& spans = a.stencil.edge_spans();
    const int lines = static_cast<int>(spans.size());
    const int down = a.anchor.y - b.anchor.y;
    const int right = a.anchor.x - b.anchor.x;
    const int begin = std::max(0, -down);
    const int end = std::min(lines, lines - down);
    double sums[4] = {};
    if (end <= begin) return {};
    thread_local std::vector<SharedRow> rows;
    rows.clear();
    for (int j = begin; j < end; ++j) {
        const DiscStencil::Row& in_a = spans[static_cast<std::size_t>(j)];
        const int line_of_b = j + down;
        const DiscStencil::Row& in_b = spans[static_cast<std::size_t>(line_of_b)];
        // Columns seen from the anchor of a.
        const int first = std::max(in_a.first, in_b.first - right);
        const int last = std::min(in_a.first + in_a.count, in_b.first - right + in_b.count);
        if (last <= first) continue;
        const int x = a.anchor.x + first;
        const int row = a.anchor.y + in_a.dy;
        const int y = row * a.stencil.spacing();
        rows.push_back({a.transmission.row(row) + x, a.kept() + in_a.at + (first - in_a.first),
                        b.kept() + in_b.at + (first + right - in_b.first),
                        static_cast<float>(x - centre_a.x), static_cast<float>(y - centre_a.y),
                        static_cast<float>(x - centre_b.x), static_cast<float>(y - centre_b.y),
                        last - first});
    }
    HWY_DYNAMIC_DISPATCH(couple_rows)
    (rows.data(), static_cast<int>(rows.size()), a.stencil.terms(), sums);
    return {sums[0], sums[1], sums[2], sums[3]};
}

double shift(const StencilView& view, Vec2 to, Redraw redraw, BeforeShift& before) {
    const FromAnchor at(to, view);
    before.redraw = redraw;
    before.transmission.resize(view.stencil.size());
    before.kept.resize(view.stencil.size());
    return HWY_DYNAMIC_DISPATCH(shift_stencil)({view, view.stencil.redrawn(redraw)},
                                               DrawnPieces(view), view.stencil.terms(), at.x, at.y,
                                               before.transmission.data(), before.kept.data());
}

void redraw(const StencilView& view, Vec2 to, Redraw redraw) {
    const FromAnchor at(to, view);
    HWY_DYNAMIC_DISPATCH(redraw_stencil)
    ({view, view.stencil.redrawn(redraw)}, DrawnPieces(view), view.stencil.terms(), at.x, at.y);
}

void undo(const StencilView& view, const BeforeShift& before) {
    float* anchor = view.transmission.row(view.anchor.y) + view.anchor.x;
    for (const DiscStencil::Piece& piece : view.stencil.redrawn(before.redraw)) {
        std::copy_n(before.transmission.data() + piece.at, DiscStencil::kLanes,
                    anchor + piece.offset);
        std::copy_n(before.kept.data() + piece.at, DiscStencil::kLanes, view.own + piece.at);
    }
}

}  // namespace grainfield::tracking
#endif
