#pragma once

#include <cstdint>
#include <vector>

#include "core/support/huge_pages.h"
#include "core/vec2.h"
#include "tracking/refine/stencil_view.h"

namespace grainfield::tracking {

/// A disc at many places within one pixel, drawn once for a whole film.
///
/// A fit that ends in a Newton step may begin with each disc up to 0.03 w per axis beside the place
/// wanted: the step goes from where the disc is drawn. There t and ∂t/∂(x, y) are read instead of
/// computed, from tables that stay in the second-level cache, and no t is kept: a third of the
/// time. Places are a square grid, the same for rows that are `spacing` pixels apart. Tables of
/// more than 3 MB (large discs with sharp edges) are not made: is_empty(), and everything is
/// computed.
class DiscTemplates {
 public:
    explicit DiscTemplates(const DiscStencil& stencil);

    static constexpr std::uint16_t kNone = 0xFFFF;
    static constexpr double kFarthest = 0.03;  ///< per axis [w]

    bool is_empty() const { return per_pixel_ == 0; }
    /// Places per pixel along an axis.
    int per_pixel() const { return per_pixel_; }

    struct Place {
        Vec2 centre;
        Anchor anchor;
        std::uint16_t number;
    };
    /// The one nearest to p. Not for empty tables.
    Place nearest(Vec2 p) const;

    DiscTemplate operator[](std::uint16_t number) const {
        const std::size_t first = 3 * size_ * number;
        return {tables_.data() + first, tables_.data() + first + size_,
                tables_.data() + first + 2 * size_, &pieces_[number]};
    }

 private:
    std::size_t size_;  ///< values of one table
    int spacing_;
    int per_pixel_ = 0;
    int columns_ = 0, rows_ = 0;
    HugeVector<HalfFloat> tables_;
    std::vector<std::vector<DiscStencil::Piece>> pieces_;
};

/// T ← T · t, from the view's template.
void draw_template(const StencilView& view);
/// The same; returns the change of Σ (I − M)².
double place_template(const StencilView& view);

/// T ← T · t_to / t with both from tables; the view stays that of before. Returns the change of Σ
/// (I − M)². The way back is the same with the templates exchanged.
double shift(const StencilView& view, const DiscTemplate& to);

/// linearise() and coupling() (drawn_disc.h) of discs that are drawn from templates.
NormalEquations linearise_template(const ConstStencilView& view);
CrossBlock couple_templates(const ConstStencilView& a, const ConstStencilView& b);

}  // namespace grainfield::tracking
