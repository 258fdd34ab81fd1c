#include "tracking/refine/disc_stencil.h"

#include <algorithm>
#include <cmath>

namespace grainfield::tracking {

DiscStencil::DiscStencil(const DiscProfile& disc, std::ptrdiff_t pitch, int spacing)
    : disc_(disc), profile_(disc), pitch_(pitch), spacing_(spacing) {
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
    const double inner = disc_.core_radius();
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

}  // namespace grainfield::tracking
