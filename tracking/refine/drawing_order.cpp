#include "tracking/refine/drawing_order.h"

#include <algorithm>
#include <numeric>

#include "core/support/parallel.h"

namespace grainfield::tracking {
namespace {

// Columns of windows in a strip: three rows of them stay in the second-level cache.
constexpr int kStrip = 8;

}  // namespace

DrawingOrder::DrawingOrder(const PaddedImage& image, const DiscStencil& stencil)
    : cell_width_(stencil.width()),
      cell_height_(static_cast<int>(stencil.rows().size())),
      rows_((image.height() + cell_height_ - 1) / cell_height_),
      columns_((image.width() + cell_width_ - 1) / cell_width_),
      strips_(std::max(1, columns_ / kStrip)) {}

int DrawingOrder::parts(const PaddedImage& image, const DiscStencil& stencil) {
    const DrawingOrder order(image, stencil);
    return order.rows_ * 2 * order.strips_;
}

DrawingOrder::DrawingOrder(const PaddedImage& image, const DiscStencil& stencil,
                           const std::vector<Anchor>& anchors)
    : DrawingOrder(image, stencil) {
    drawn_.resize(static_cast<std::size_t>(parts(image, stencil)));
    visited_.resize(drawn_.size());
    const auto column_of = [&](std::uint32_t j) {
        return std::clamp(anchors[j].x / cell_width_, 0, columns_ - 1);
    };
    std::vector<std::uint32_t> begin(static_cast<std::size_t>(columns_) + 1, 0);
    for (std::uint32_t j = 0; j < anchors.size(); ++j) {
        ++begin[static_cast<std::size_t>(column_of(j)) + 1];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    std::vector<std::uint32_t> by_column(anchors.size());
    for (std::uint32_t j = 0; j < by_column.size(); ++j) {
        by_column[begin[static_cast<std::size_t>(column_of(j))]++] = j;
    }
    for (const std::uint32_t j : by_column) {
        const int column = column_of(j);
        const int row = std::clamp(anchors[j].y / cell_height_, 0, rows_ - 1);
        const int s = std::min(column * strips_ / columns_, strips_ - 1);
        const int first = first_column(s);
        const int end = first_column(s + 1);
        const bool is_seam = s + 1 < strips_ && column == end - 1;
        const bool is_before = s + 1 < strips_ && column == end - 2;
        const bool is_after = s > 0 && column == first;
        drawn_[is_seam ? seam(s, row) : strip(s, row)].push_back(j);
        visited_[is_seam || is_before ? seam(s, row)
                 : is_after           ? seam(s - 1, row)
                                      : strip(s, row)]
            .push_back(j);
    }
}

void DrawingOrder::go_down(int s, bool is_seam, const PaddedImage& drawn, const PaddedImage& seen,
                           const Draw& draw, const Visit& visit) const {
    const int left = first_column(s) * cell_width_ - cell_width_ / 2;
    const int right = first_column(s + 1) * cell_width_ + cell_width_ / 2;
    const auto fetch_row = [&](const PaddedImage& image, int row) {
        if (is_seam) return;  // has just been used
        const int top = row * cell_height_ + cell_height_ / 2;
        image.fetch(left, top, right, top + cell_height_);
    };
    const auto at = [&](int row) { return is_seam ? seam(s, row) : strip(s, row); };
    for (int row = 0; row <= rows_; ++row) {
        fetch_row(drawn, row + 1);
        if (row < rows_) {
            fetch_row(seen, row);
            for (const std::uint32_t j : drawn_[at(row)]) draw(j);
        }
        if (row > 0) visit(static_cast<int>(at(row - 1)), visited_[at(row - 1)]);
    }
}

void DrawingOrder::draw_and_visit(int threads, const PaddedImage& drawn, const PaddedImage& seen,
                                  const Draw& draw, const Visit& visit) const {
    for (const bool is_seam : {false, true}) {
        parallel_for(strips_ - (is_seam ? 1 : 0), threads, [&](std::int64_t s) {
            go_down(static_cast<int>(s), is_seam, drawn, seen, draw, visit);
        });
    }
}

void DrawingOrder::visit(int threads, const Visit& visit) const {
    parallel_for(static_cast<std::int64_t>(visited_.size()), threads, [&](std::int64_t part) {
        visit(static_cast<int>(part), visited_[static_cast<std::size_t>(part)]);
    });
}

}  // namespace grainfield::tracking
