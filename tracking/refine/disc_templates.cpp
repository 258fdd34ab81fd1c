#include "tracking/refine/disc_templates.h"

#include <algorithm>
#include <cmath>

namespace grainfield::tracking {
namespace {

constexpr double kLargest = 3 << 20;  // [byte]

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

}  // namespace grainfield::tracking
