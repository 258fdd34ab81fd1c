#include "tracking/refine/disc_templates.h"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "tracking/refine/disc_templates.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "tracking/refine/stencil_view-inl.h"

#ifndef GRAINFIELD_SHARED_TEMPLATES
#define GRAINFIELD_SHARED_TEMPLATES
namespace grainfield::tracking {

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

/// t and −∂t/∂(x, y)/t of every piece.
template <class Profile>
HWY_INLINE void tabulate_on(const DiscStencil::Piece* pieces, std::size_t n, const Profile& disc,
                            float x, float y, HalfFloat* t, HalfFloat* along, HalfFloat* down) {
    const int lanes = static_cast<int>(hn::Lanes(kTag));
    for (std::size_t j = 0; j < n; ++j) {
        const DiscStencil::Piece& piece = pieces[j];
        const Vector dy = hn::Set(kTag, piece.dy - y);
        for (int i = 0; i < DiscStencil::kLanes; i += lanes) {
            const Vector dx = hn::Iota(kTag, piece.dx - x + static_cast<float>(i));
            const std::ptrdiff_t at = piece.at + i;
            const Vector kept = store_half(disc.rough_transmission(dx, hn::Mul(dy, dy)), t + at);
            const Vector r2 = hn::MulAdd(dx, dx, hn::Mul(dy, dy));
            const Vector slope = disc.exact_gradient(kept, r2);
            store_half(hn::Mul(slope, dx), along + at);
            store_half(hn::Mul(slope, dy), down + at);
        }
    }
}

void tabulate_stencil(const DiscStencil::Piece* pieces, std::size_t n, const DiscTerms& terms,
                      float x, float y, HalfFloat* t, HalfFloat* along, HalfFloat* down) {
    with_profile(terms, [&](const auto& disc)
                            HWY_ATTR { tabulate_on(pieces, n, disc, x, y, t, along, down); });
}

template <bool with_change>
HWY_INLINE double draw_from_template(const StencilPieces& s, const DrawnPieces& to) {
    Vector change = hn::Zero(kTag);
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(kTag));
    const DiscStencil::Piece* const end = s.pieces + s.n;
    float* const image = to.transmission;
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

double place_pieces(const StencilPieces& s, const DrawnPieces& to) {
    return draw_from_template<true>(s, to);
}

void draw_pieces(const StencilPieces& s, const DrawnPieces& to) {
    draw_from_template<false>(s, to);
}

void linearise_tables(const StencilPieces& s, const HalfFloat* along, const HalfFloat* down,
                      double* sums) {
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(kTag));
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

void couple_tables(const SharedTemplates& s, double* sums) {
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

double shift_tables(const StencilPieces& s, const DrawnPieces& drawn, const HalfFloat* to) {
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(kTag));
    Vector change = hn::Zero(kTag);
    for (std::size_t j = 0; j < s.n; ++j) {
        const DiscStencil::Piece& piece = s.pieces[j];
        for (std::ptrdiff_t i = 0; i < DiscStencil::kLanes; i += lanes) {
            float* transmission = drawn.transmission + piece.offset + i;
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

}  // namespace grainfield::tracking::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace grainfield::tracking {

HWY_EXPORT(tabulate_stencil);
HWY_EXPORT(draw_pieces);
HWY_EXPORT(place_pieces);
HWY_EXPORT(linearise_tables);
HWY_EXPORT(couple_tables);
HWY_EXPORT(shift_tables);

namespace {

constexpr double kLargest = 3 << 20;  // [byte]

/// Fills the tables of a template; centre seen from the anchor [px].
void tabulate(const DiscStencil& stencil, Vec2 centre, HalfFloat* t, HalfFloat* x, HalfFloat* y) {
    HWY_DYNAMIC_DISPATCH(tabulate_stencil)
    (stencil.pieces().data(), stencil.pieces().size(), stencil.terms(),
     static_cast<float>(centre.x), static_cast<float>(centre.y), t, x, y);
}

}  // namespace

DiscTemplates::DiscTemplates(const DiscStencil& stencil)
    : size_(stencil.size()), spacing_(stencil.spacing()) {
    const double wanted = std::ceil(0.5 / (kFarthest * stencil.disc().edge_width));
    const double count = wanted * wanted * spacing_;
    const double values = 3 * count * static_cast<double>(size_);
    if (!(count < kNone) || values * sizeof(HalfFloat) > kLargest) return;
    per_pixel_ = static_cast<int>(wanted);
    columns_ = per_pixel_;
    rows_ = per_pixel_ * spacing_;
    // Vectors may run beyond the last table.
    tables_.resize(static_cast<std::size_t>(values) + DiscStencil::kLanes);
    pieces_.reserve(static_cast<std::size_t>(count));
    HalfFloat* table = tables_.data();
    for (int row = 0; row < rows_; ++row) {
        for (int column = 0; column < columns_; ++column, table += 3 * size_) {
            const Vec2 centre{(column + 0.5) / per_pixel_ - 0.5,
                              (row + 0.5) / per_pixel_ - 0.5 * spacing_};
            tabulate(stencil, centre, table, table + size_, table + 2 * size_);
            std::vector<DiscStencil::Piece>& pieces = pieces_.emplace_back();
            constexpr HalfFloat kOne = 0x3C00;
            for (const DiscStencil::Piece& piece : stencil.pieces()) {
                const HalfFloat* t = table + piece.at;
                if (std::any_of(t, t + DiscStencil::kLanes, [](HalfFloat v) { return v != kOne; }))
                    pieces.push_back(piece);
            }
        }
    }
}

DiscTemplates::Place DiscTemplates::nearest(Vec2 p) const {
    Place place;
    place.anchor = Anchor::of(p, spacing_);
    const double x = p.x - place.anchor.x;
    const double y = p.y - static_cast<double>(place.anchor.y) * spacing_;
    const int column = std::clamp(static_cast<int>((x + 0.5) * per_pixel_), 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>((y + 0.5 * spacing_) * per_pixel_), 0, rows_ - 1);
    place.number = static_cast<std::uint16_t>(row * columns_ + column);
    place.centre = {
        place.anchor.x + (column + 0.5) / per_pixel_ - 0.5,
        static_cast<double>(place.anchor.y) * spacing_ + (row + 0.5) / per_pixel_ - 0.5 * spacing_};
    return place;
}

void draw_template(const StencilView& view) {
    HWY_DYNAMIC_DISPATCH(draw_pieces)({view, *view.shape.pieces}, DrawnPieces(view));
}

double place_template(const StencilView& view) {
    return HWY_DYNAMIC_DISPATCH(place_pieces)({view, *view.shape.pieces}, DrawnPieces(view));
}

double shift(const StencilView& view, const DiscTemplate& to) {
    return HWY_DYNAMIC_DISPATCH(shift_tables)({view, view.stencil.pieces()}, DrawnPieces(view),
                                              to.t);
}

NormalEquations linearise_template(const ConstStencilView& view) {
    double sums[6] = {};
    HWY_DYNAMIC_DISPATCH(linearise_tables)
    ({view, view.stencil.edge_pieces()}, view.shape.x, view.shape.y, sums);
    return {sums[0], sums[1], sums[2], sums[3], sums[4], sums[5]};
}

CrossBlock couple_templates(const ConstStencilView& a, const ConstStencilView& b) {
    const std::vector<DiscStencil::Row>& spans = a.stencil.edge_spans();
    const int lines = static_cast<int>(spans.size());
    const int down = a.anchor.y - b.anchor.y;
    const int right = a.anchor.x - b.anchor.x;
    const int begin = std::max(0, -down);
    const int end = std::min(lines, lines - down);
    double sums[4] = {};
    if (end <= begin) return {};
    HWY_DYNAMIC_DISPATCH(couple_tables)
    ({spans.data() + begin, spans.data() + begin + down, end - begin, right,
      a.transmission.row(a.anchor.y) + a.anchor.x, a.transmission.pitch(), a.shape.x, a.shape.y,
      b.shape.x, b.shape.y},
     sums);
    return {sums[0], sums[1], sums[2], sums[3]};
}

}  // namespace grainfield::tracking
#endif
