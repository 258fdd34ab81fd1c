#include "tracking/refine/disc_stencil.h"

#include <algorithm>
#include <cmath>

#include "core/support/huge_pages.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/refine/disc_stencil.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tracking/model/disc_profile-inl.h"

#ifndef GRAINFIELD_STENCIL_ROWS
#define GRAINFIELD_STENCIL_ROWS
namespace grainfield::tracking {

/// A view as the kernels want it: pointers to the anchor pixel.
struct StencilPieces {
    const DiscStencil::Piece* pieces;
    std::size_t n;
    const float* darkness;
    float* transmission;
    const HalfFloat* kept;
    HalfFloat* own;
};

/// A run of pixels in the windows of two discs; distances of the first one from either centre.
struct SharedRow {
    const float* transmission;
    const HalfFloat *a, *b;
    float ax, ay, bx, by;
    int count;
};

/// Two discs that are drawn from templates: what their windows share begins at these places.
struct SharedTemplates {
    const DiscStencil::Row* a;  ///< first shared row of the edge, in the window of each
    const DiscStencil::Row* b;
    int rows;
    int right;                  ///< from the anchor of b to that of a
    const float* transmission;  ///< at the anchor of a
    std::ptrdiff_t pitch;
    const HalfFloat *ax, *ay, *bx, *by;
};

}  // namespace grainfield::tracking
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

/// One vector of a row: what a kernel reads and writes.
struct Spot {
    const float* darkness;
    float* transmission;
    const HalfFloat* kept;
    HalfFloat* own;
    std::size_t at;
};

/// Calls body(dx, dy, spot) for every vector of the stencil; dx, dy from (x, y), which is the
/// centre seen from the anchor.
template <class Body>
HWY_INLINE void for_each_spot(const StencilPieces& s, float x, float y, Body&& body) {
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
            const std::size_t at = static_cast<std::size_t>(piece.at) + i;
            const std::ptrdiff_t offset = piece.offset + static_cast<std::ptrdiff_t>(i);
            body(dx, dy,
                 Spot{s.darkness + offset, s.transmission + offset, s.kept + at, s.own + at, at});
            dx = hn::Add(dx, next);
        }
    }
}

/// t to the accuracy of a half float, 5e-4 of its value.
HWY_INLINE Vector rough_transmission(Vector dx, Vector dy2, const DiscTerms& disc) {
    const Vector r2 = hn::MulAdd(dx, dx, dy2);
    const Vector floored = hn::Max(r2, hn::Set(kTag, 1e-6F));
    const Vector estimate = hn::ApproximateReciprocalSqrt(floored);
    // One step of Newton: r to 1e-6 px.
    const Vector half = hn::Mul(hn::Mul(floored, estimate), hn::Set(kTag, 0.5F));
    const Vector r_inv = hn::Mul(estimate, hn::NegMulAdd(half, estimate, hn::Set(kTag, 1.5F)));
    const Vector limit = hn::Set(kTag, 2.0F * static_cast<float>(DiscProfile::kReachInWidths));
    Vector u = hn::NegMulAdd(hn::Mul(floored, r_inv), hn::Set(kTag, disc.two_over_width),
                             hn::Set(kTag, disc.radius_over));
    u = hn::Max(hn::Min(u, limit), hn::Neg(limit));
    const Vector t = hn::ApproximateReciprocal(hn::Add(exp_rough(u), hn::Set(kTag, 1.0F)));
    return hn::IfThenElse(hn::Lt(r2, hn::Set(kTag, disc.reach2)), t, hn::Set(kTag, 1.0F));
}

/// The change of (I − 1 + T)² when T becomes `now`: a² − b² = (a − b)(a + b).
HWY_INLINE Vector change_of(Vector darkness, Vector before, Vector now) {
    const Vector b = residual_of(darkness, before);
    const Vector step = hn::Sub(now, before);
    return hn::Mul(step, hn::MulAdd(hn::Set(kTag, 2.0F), b, step));
}

/// T ← T · t. The change of the misfit asks for the darkness, hence the choice.
template <bool with_change>
HWY_INLINE double draw(const StencilPieces& s, const DiscTerms& disc, float x, float y) {
    Vector change = hn::Zero(kTag);
    const Vector reach2 = hn::Set(kTag, disc.reach2);
    for_each_spot(s, x, y, [&](Vector dx, Vector dy, Spot spot) HWY_ATTR {
        const Vector dy2 = hn::Mul(dy, dy);
        // The last vector of most rows is there for discs off the anchor only.
        if (hn::AllFalse(kTag, hn::Lt(hn::MulAdd(dx, dx, dy2), reach2))) {
            store_half(hn::Set(kTag, 1.0F), spot.own);
            return;
        }
        const Vector t = store_half(rough_transmission(dx, dy2, disc), spot.own);
        const Vector old = hn::LoadU(kTag, spot.transmission);
        const Vector now = hn::Mul(old, t);
        hn::StoreU(now, kTag, spot.transmission);
        if constexpr (with_change) {
            change = hn::Add(change, change_of(hn::LoadU(kTag, spot.darkness), old, now));
        }
    });
    return with_change ? sum(change) : 0;
}

/// t and −∂t/∂(x, y)/t = (2/w) P (x − centre)/r of every piece.
void tabulate_stencil(const DiscStencil::Piece* pieces, std::size_t n, const DiscTerms& disc,
                      float x, float y, HalfFloat* t, HalfFloat* along, HalfFloat* down) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    const Vector one = hn::Set(kTag, 1.0F);
    for (std::size_t j = 0; j < n; ++j) {
        const DiscStencil::Piece& piece = pieces[j];
        const Vector dy = hn::Set(kTag, piece.dy - y);
        for (int i = 0; i < DiscStencil::kLanes; i += lanes) {
            const Vector dx = hn::Iota(kTag, piece.dx - x + static_cast<float>(i));
            const std::ptrdiff_t at = piece.at + i;
            const Vector kept = store_half(rough_transmission(dx, hn::Mul(dy, dy), disc), t + at);
            const Vector r2 = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
            const Vector slope =
                hn::Div(hn::Mul(hn::Set(kTag, disc.two_over_width), hn::Sub(one, kept)),
                        hn::Sqrt(hn::Add(r2, hn::Set(kTag, 1e-12F))));
            store_half(hn::Mul(slope, dx), along + at);
            store_half(hn::Mul(slope, dy), down + at);
        }
    }
}

template <bool with_change>
HWY_INLINE double draw_template(const StencilPieces& s) {
    Vector change = hn::Zero(kTag);
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(kTag));
    const DiscStencil::Piece* const end = s.pieces + s.n;
    float* const image = s.transmission;
    const float* const darkness = s.darkness;
    const HalfFloat* const kept = s.kept;
    for (const DiscStencil::Piece* piece = s.pieces; piece != end; ++piece) {
        float* const transmission = image + piece->offset;
        const HalfFloat* const t = kept + piece->at;
        for (std::ptrdiff_t i = 0; i < DiscStencil::kLanes; i += lanes) {
            const Vector old = hn::LoadU(kTag, transmission + i);
            const Vector now = hn::Mul(old, load_half(t + i));
            hn::StoreU(now, kTag, transmission + i);
            if constexpr (with_change) {
                change = hn::Add(
                    change, change_of(hn::LoadU(kTag, darkness + piece->offset + i), old, now));
            }
        }
    }
    return with_change ? sum(change) : 0;
}

double place_pieces(const StencilPieces& s) {
    return draw_template<true>(s);
}

void draw_pieces(const StencilPieces& s) {
    draw_template<false>(s);
}

double place_stencil(const StencilPieces& s, const DiscTerms& disc, float x, float y) {
    return draw<true>(s, disc, x, y);
}

void draw_stencil(const StencilPieces& s, const DiscTerms& disc, float x, float y) {
    draw<false>(s, disc, x, y);
}

double lift_stencil(const StencilPieces& s) {
    Vector change = hn::Zero(kTag);
    for_each_spot(s, 0, 0, [&](Vector, Vector, Spot spot) HWY_ATTR {
        const Vector old = hn::LoadU(kTag, spot.transmission);
        const Vector now = hn::Mul(old, reciprocal(load_half(spot.kept)));
        hn::StoreU(now, kTag, spot.transmission);
        change = hn::Add(change, change_of(hn::LoadU(kTag, spot.darkness), old, now));
    });
    return sum(change);
}

double explained_stencil(const StencilPieces& s) {
    Vector change = hn::Zero(kTag);
    for_each_spot(s, 0, 0, [&](Vector, Vector, Spot spot) HWY_ATTR {
        const Vector old = hn::LoadU(kTag, spot.transmission);
        const Vector now = hn::Mul(old, reciprocal(load_half(spot.kept)));
        change = hn::Add(change, change_of(hn::LoadU(kTag, spot.darkness), old, now));
    });
    return sum(change);
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

void linearise_stencil(const StencilPieces& s, const DiscTerms& disc, float x, float y,
                       double* sums) {
    NormalSums n = NormalSums::none();
    const Vector one = hn::Set(kTag, 1.0F);
    const Vector slope = hn::Set(kTag, disc.two_over_width);
    for_each_spot(s, x, y, [&](Vector dx, Vector dy, Spot spot) HWY_ATTR {
        const Vector transmission = hn::LoadU(kTag, spot.transmission);
        const Vector residual = residual_of(hn::LoadU(kTag, spot.darkness), transmission);
        // Beyond reach t is 1 and P is 0. An estimate is enough for the direction of a step, and
        // keeps r = 0 finite.
        const Vector p = hn::Sub(one, load_half(spot.kept));
        const Vector r2 = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
        const Vector r_inv = hn::ApproximateReciprocalSqrt(hn::Add(r2, hn::Set(kTag, 1e-12F)));
        const Vector g = hn::Mul(hn::Mul(transmission, slope), hn::Mul(p, r_inv));
        const Vector jx = hn::Mul(g, dx);
        const Vector jy = hn::Mul(g, dy);
        n.add(jx, jy, residual);
    });
    n.store(sums);
}

void local_misfit_stencil(const StencilPieces& s, const DiscTerms& disc, float x, float y,
                          double* sums) {
    Vector misfit = hn::Zero(kTag);
    Vector pixels = misfit;
    const Vector one = hn::Set(kTag, 1.0F);
    const Vector reach2 = hn::Set(kTag, disc.reach2);
    for_each_spot(s, x, y, [&](Vector dx, Vector dy, Spot spot) HWY_ATTR {
        const Vector transmission = hn::LoadU(kTag, spot.transmission);
        // Where nothing is looked at, it is 0 and there is no residual.
        const auto is_visible = hn::Gt(transmission, hn::Zero(kTag));
        const auto is_near = hn::Le(hn::MulAdd(dx, dx, hn::Mul(dy, dy)), reach2);
        const Vector residual =
            hn::IfThenElseZero(is_near, residual_of(hn::LoadU(kTag, spot.darkness), transmission));
        misfit = hn::MulAdd(residual, residual, misfit);
        pixels = hn::Add(pixels, hn::IfThenElseZero(hn::And(is_near, is_visible), one));
    });
    sums[0] = sum(misfit);
    sums[1] = sum(pixels);
}

void linearise_template(const StencilPieces& s, const HalfFloat* along, const HalfFloat* down,
                        double* sums) {
    const std::ptrdiff_t lanes = static_cast<std::ptrdiff_t>(hn::Lanes(kTag));
    NormalSums n = NormalSums::none();
    for (std::size_t j = 0; j < s.n; ++j) {
        const DiscStencil::Piece& piece = s.pieces[j];
        for (std::ptrdiff_t i = 0; i < DiscStencil::kLanes; i += lanes) {
            const Vector transmission = hn::LoadU(kTag, s.transmission + piece.offset + i);
            const Vector residual =
                residual_of(hn::LoadU(kTag, s.darkness + piece.offset + i), transmission);
            const Vector jx = hn::Mul(transmission, load_half(along + piece.at + i));
            const Vector jy = hn::Mul(transmission, load_half(down + piece.at + i));
            n.add(jx, jy, residual);
        }
    }
    n.store(sums);
}

void couple_templates(const SharedTemplates& s, double* sums) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    CrossSums block = CrossSums::none();
    for (int j = 0; j < s.rows; ++j) {
        const DiscStencil::Row& in_a = s.a[j];
        const DiscStencil::Row& in_b = s.b[j];
        const int first = std::max(in_a.first, in_b.first - s.right);
        const int end = std::min(in_a.first + in_a.count, in_b.first - s.right + in_b.count);
        const float* transmission = s.transmission + in_a.dy * s.pitch;
        const int at_a = in_a.at - in_a.first;
        const int at_b = in_b.at - in_b.first + s.right;
        for (int x = first; x < end; x += lanes) {
            const auto inside = hn::FirstN(kTag, static_cast<std::size_t>(end - x));
            const Vector t = hn::IfThenElseZero(inside, hn::LoadU(kTag, transmission + x));
            const Vector both = hn::Mul(t, t);
            const Vector from_a = hn::Mul(both, load_half(s.ax + at_a + x));
            const Vector down_a = hn::Mul(both, load_half(s.ay + at_a + x));
            const Vector from_b = load_half(s.bx + at_b + x);
            const Vector down_b = load_half(s.by + at_b + x);
            block.add(from_a, down_a, from_b, down_b);
        }
    }
    block.store(sums);
}

void couple_rows(const SharedRow* rows, int n, const DiscTerms& disc, double* sums) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    const Vector iota = hn::Iota(kTag, 0.0F);
    const Vector one = hn::Set(kTag, 1.0F);
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
            const Vector g =
                hn::Mul(hn::LoadU(kTag, row.transmission + i), hn::Set(kTag, disc.two_over_width));
            const Vector pa = hn::Sub(one, load_half(row.a + at));
            const Vector pb = hn::Sub(one, load_half(row.b + at));
            const Vector ra = hn::MulAdd(ax, ax, hn::MulAdd(ay, ay, floor));
            const Vector rb = hn::MulAdd(bx, bx, hn::MulAdd(by, by, floor));
            const Vector r_inv =
                hn::Mul(hn::ApproximateReciprocalSqrt(ra), hn::ApproximateReciprocalSqrt(rb));
            const Vector all = hn::Mul(hn::Mul(hn::Mul(g, g), hn::Mul(pa, pb)), r_inv);
            const Vector both = hn::IfThenElseZero(inside, all);
            const Vector from_a = hn::Mul(both, ax);
            const Vector down_a = hn::Mul(both, ay);
            block.add(from_a, down_a, bx, by);
        }
    }
    block.store(sums);
}

/// T ← T · t / t_before. Without a way back (null) the change is not asked for either.
template <bool with_way_back>
HWY_INLINE double shift(const StencilPieces& s, const DiscTerms& disc, float x, float y,
                        float* transmission_before, HalfFloat* kept_before) {
    Vector change = hn::Zero(kTag);
    for_each_spot(s, x, y, [&](Vector dx, Vector dy, Spot spot) HWY_ATTR {
        const Vector old = hn::LoadU(kTag, spot.transmission);
        const auto halves = hn::LoadU(Halves(), spot.kept);
        if constexpr (with_way_back) {
            hn::StoreU(old, kTag, transmission_before + spot.at);
            hn::StoreU(halves, Halves(), kept_before + spot.at);
        }
        const Vector before = hn::PromoteTo(StencilTag(), hn::BitCast(HalfFloats(), halves));
        const Vector t = store_half(rough_transmission(dx, hn::Mul(dy, dy), disc), spot.own);
        const Vector now = hn::Mul(hn::Mul(old, t), reciprocal(before));
        hn::StoreU(now, kTag, spot.transmission);
        if constexpr (with_way_back) {
            change = hn::Add(change, change_of(hn::LoadU(kTag, spot.darkness), old, now));
        }
    });
    return with_way_back ? sum(change) : 0;
}

double shift_template(const StencilPieces& s, const HalfFloat* to) {
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(kTag));
    Vector change = hn::Zero(kTag);
    for (std::size_t j = 0; j < s.n; ++j) {
        const DiscStencil::Piece& piece = s.pieces[j];
        for (std::ptrdiff_t i = 0; i < DiscStencil::kLanes; i += lanes) {
            float* transmission = s.transmission + piece.offset + i;
            const Vector old = hn::LoadU(kTag, transmission);
            const Vector ratio =
                hn::Mul(load_half(to + piece.at + i), reciprocal(load_half(s.kept + piece.at + i)));
            const Vector now = hn::Mul(old, ratio);
            hn::StoreU(now, kTag, transmission);
            change = hn::Add(change,
                             change_of(hn::LoadU(kTag, s.darkness + piece.offset + i), old, now));
        }
    }
    return sum(change);
}

double shift_stencil(const StencilPieces& s, const DiscTerms& disc, float x, float y,
                     float* transmission_before, HalfFloat* kept_before) {
    return shift<true>(s, disc, x, y, transmission_before, kept_before);
}

void redraw_stencil(const StencilPieces& s, const DiscTerms& disc, float x, float y) {
    shift<false>(s, disc, x, y, nullptr, nullptr);
}

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {

HWY_EXPORT(tabulate_stencil);
HWY_EXPORT(draw_pieces);
HWY_EXPORT(place_pieces);
HWY_EXPORT(linearise_template);
HWY_EXPORT(couple_templates);
HWY_EXPORT(shift_template);
HWY_EXPORT(draw_stencil);
HWY_EXPORT(local_misfit_stencil);
HWY_EXPORT(place_stencil);
HWY_EXPORT(lift_stencil);
HWY_EXPORT(explained_stencil);
HWY_EXPORT(linearise_stencil);
HWY_EXPORT(couple_rows);
HWY_EXPORT(shift_stencil);
HWY_EXPORT(redraw_stencil);

namespace {

StencilPieces pieces_of(const StencilView& view, const std::vector<DiscStencil::Piece>& pieces) {
    const Anchor a = view.anchor;
    return {pieces.data(),
            pieces.size(),
            view.darkness.row(a.y) + a.x,
            view.transmission.row(a.y) + a.x,
            view.kept(),
            view.own};
}

StencilPieces pieces_of(const StencilView& view) {
    return pieces_of(view, view.stencil.pieces());
}

/// A centre seen from the anchor [px].
struct FromAnchor {
    float x, y;
    FromAnchor(Vec2 centre, const StencilView& view)
        : x(static_cast<float>(centre.x - view.anchor.x)),
          y(static_cast<float>(centre.y - view.anchor.y * view.stencil.spacing())) {}
};

}  // namespace

DiscStencil::DiscStencil(const DiscProfile& disc, std::ptrdiff_t pitch, int spacing)
    : disc_(disc), pitch_(pitch), spacing_(spacing) {
    const double reach = disc.reach();
    const int half = static_cast<int>(std::floor(reach / spacing + kRoom));
    for (int dy = -half; dy <= half; ++dy) {
        const double height = spacing * std::max(0.0, std::abs(dy) - kRoom);
        const double chord = std::sqrt(std::max(0.0, reach * reach - height * height)) + kRoom;
        const int first = -static_cast<int>(std::floor(chord));
        const int count = (1 - 2 * first + kLanes - 1) / kLanes * kLanes;
        rows_.push_back({dy, first, count, static_cast<int>(size_)});
        first_ = std::min(first_, first);
        last_ = std::max(last_, first + count - 1);
        size_ += static_cast<std::size_t>(count);
        for (int x = first; x < first + count; x += kLanes) {
            pieces_.push_back(piece(rows_.back(), x));
        }
        add_edge_row(rows_.back());
    }
}

DiscStencil::Piece DiscStencil::piece(const Row& row, int x) const {
    return {static_cast<std::int32_t>(row.dy * pitch_ + x), row.at + x - row.first,
            static_cast<float>(x), static_cast<float>(row.dy * spacing_)};
}

void DiscStencil::add_edge_row(const Row& row) {
    const double outer = disc_.edge_reach();
    const double inner = std::max(0.0, disc_.diameter - outer);
    const int distance = std::abs(row.dy);
    const double height = spacing_ * std::max(0.0, distance - kRoom);
    if (height >= outer) return;
    const double chord = std::sqrt(outer * outer - height * height) + kRoom;
    const int reach = std::min(static_cast<int>(std::floor(chord)), -row.first);
    const int count = (2 * reach + kLanes) / kLanes * kLanes;
    const int first = std::min(-reach, row.first + row.count - count);
    edge_spans_.push_back({row.dy, first, count, row.at + first - row.first});
    // Columns |dx| ≤ core lie in the core wherever the centre may be.
    const double low = spacing_ * (distance + kRoom);
    const double core = std::sqrt(std::max(0.0, inner * inner - low * low)) - kRoom;
    for (int x = first; x < first + count; x += kLanes) {
        if (std::max(std::abs(x), std::abs(x + kLanes - 1)) <= core) continue;
        edge_pieces_.push_back(piece(row, x));
    }
}

Anchor Anchor::of(Vec2 centre, int spacing) {
    return {static_cast<int>(std::lround(centre.x)),
            static_cast<int>(std::lround(centre.y / spacing))};
}

bool Anchor::holds(Vec2 centre, int spacing) const {
    return std::abs(centre.x - x) <= DiscStencil::kRoom &&
           std::abs(centre.y / spacing - y) <= DiscStencil::kRoom;
}

void fetch(const StencilView& view) {
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

void tabulate(const DiscStencil& stencil, Vec2 centre, HalfFloat* t, HalfFloat* x, HalfFloat* y) {
    HWY_DYNAMIC_DISPATCH(tabulate_stencil)
    (stencil.pieces().data(), stencil.pieces().size(), terms_of(stencil.disc()),
     static_cast<float>(centre.x), static_cast<float>(centre.y), t, x, y);
}

double place(const StencilView& view, Vec2 centre) {
    const FromAnchor at(centre, view);
    return HWY_DYNAMIC_DISPATCH(place_stencil)(pieces_of(view), terms_of(view.stencil.disc()), at.x,
                                               at.y);
}

void draw(const StencilView& view, Vec2 centre) {
    const FromAnchor at(centre, view);
    HWY_DYNAMIC_DISPATCH(draw_stencil)
    (pieces_of(view), terms_of(view.stencil.disc()), at.x, at.y);
}

void draw_template(const StencilView& view) {
    HWY_DYNAMIC_DISPATCH(draw_pieces)(pieces_of(view, *view.shape.pieces));
}

double place_template(const StencilView& view) {
    return HWY_DYNAMIC_DISPATCH(place_pieces)(pieces_of(view, *view.shape.pieces));
}

double lift(const StencilView& view) {
    return HWY_DYNAMIC_DISPATCH(lift_stencil)(pieces_of(view));
}

double explained(const StencilView& view) {
    return HWY_DYNAMIC_DISPATCH(explained_stencil)(pieces_of(view));
}

NormalEquations linearise(const StencilView& view, Vec2 centre) {
    const FromAnchor at(centre, view);
    double sums[6] = {};
    const StencilPieces pieces = pieces_of(view, view.stencil.edge_pieces());
    if (view.has_shape()) {
        HWY_DYNAMIC_DISPATCH(linearise_template)(pieces, view.shape.x, view.shape.y, sums);
    } else {
        HWY_DYNAMIC_DISPATCH(linearise_stencil)
        (pieces, terms_of(view.stencil.disc()), at.x, at.y, sums);
    }
    return {sums[0], sums[1], sums[2], sums[3], sums[4], sums[5]};
}

LocalMisfit local_misfit(const StencilView& view, Vec2 centre) {
    const FromAnchor at(centre, view);
    double sums[2] = {};
    HWY_DYNAMIC_DISPATCH(local_misfit_stencil)
    (pieces_of(view), terms_of(view.stencil.disc()), at.x, at.y, sums);
    return {sums[0], sums[1]};
}

CrossBlock coupling(const StencilView& a, Vec2 centre_a, const StencilView& b, Vec2 centre_b) {
    const std::vector<DiscStencil::Row>& spans = a.stencil.edge_spans();
    const int lines = static_cast<int>(spans.size());
    const int down = a.anchor.y - b.anchor.y;
    const int right = a.anchor.x - b.anchor.x;
    const int begin = std::max(0, -down);
    const int end = std::min(lines, lines - down);
    double sums[4] = {};
    if (end <= begin) return {};
    if (a.has_shape() && b.has_shape()) {
        HWY_DYNAMIC_DISPATCH(couple_templates)
        ({spans.data() + begin, spans.data() + begin + down, end - begin, right,
          a.transmission.row(a.anchor.y) + a.anchor.x, a.transmission.pitch(), a.shape.x, a.shape.y,
          b.shape.x, b.shape.y},
         sums);
        return {sums[0], sums[1], sums[2], sums[3]};
    }
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
    (rows.data(), static_cast<int>(rows.size()), terms_of(a.stencil.disc()), sums);
    return {sums[0], sums[1], sums[2], sums[3]};
}

double shift(const StencilView& view, Vec2 to, Redraw redraw, BeforeShift& before) {
    const FromAnchor at(to, view);
    before.redraw = redraw;
    before.transmission.resize(view.stencil.size());
    before.kept.resize(view.stencil.size());
    return HWY_DYNAMIC_DISPATCH(shift_stencil)(pieces_of(view, view.stencil.redrawn(redraw)),
                                               terms_of(view.stencil.disc()), at.x, at.y,
                                               before.transmission.data(), before.kept.data());
}

double shift(const StencilView& view, const DiscTemplate& to) {
    return HWY_DYNAMIC_DISPATCH(shift_template)(pieces_of(view), to.t);
}

void redraw(const StencilView& view, Vec2 to, Redraw redraw) {
    const FromAnchor at(to, view);
    HWY_DYNAMIC_DISPATCH(redraw_stencil)
    (pieces_of(view, view.stencil.redrawn(redraw)), terms_of(view.stencil.disc()), at.x, at.y);
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
