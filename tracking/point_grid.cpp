#include "tracking/point_grid.h"

#include <algorithm>
#include <cmath>

namespace grainfield::tracking {

PointGrid::PointGrid(int width, int height, double distance)
    : size_(std::max(distance, 1.0)),
      columns_(static_cast<int>(width / size_) + 1),
      rows_(static_cast<int>(height / size_) + 1),
      head_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kNone) {}

PointGrid::PointGrid(const std::vector<Vec2>& points, double distance) : head_(1, kNone) {
    if (points.empty()) return;
    Vec2 high = low_ = points[0];
    for (const Vec2 p : points) {
        low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    const double extent = std::max({high.x - low_.x, high.y - low_.y, 1e-9});
    const double finest = extent / (2 * std::sqrt(static_cast<double>(points.size())) + 1);
    size_ = std::max(distance, finest);
    columns_ = static_cast<int>((high.x - low_.x) / size_) + 1;
    rows_ = static_cast<int>((high.y - low_.y) / size_) + 1;

    // The points of a cell stand side by side, in ascending order (counting sort).
    std::vector<std::uint32_t> next(
        static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_) + 1, 0);
    std::vector<std::uint32_t> cell_of(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        cell_of[i] = static_cast<std::uint32_t>(cell(column(points[i].x), row(points[i].y)));
        ++next[cell_of[i] + 1];
    }
    for (std::size_t c = 1; c < next.size(); ++c) next[c] += next[c - 1];
    head_.assign(next.size() - 1, kNone);
    entries_.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::uint32_t c = cell_of[i];
        const std::uint32_t at = next[c]++;
        if (head_[c] == kNone) {
            head_[c] = at;
        } else {
            entries_[at - 1].next = at;
        }
        entries_[at] = {points[i], static_cast<std::uint32_t>(i), kNone};
    }
}

}  // namespace grainfield::tracking
