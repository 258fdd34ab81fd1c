#include "simulate/render/optics/disc_scan.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

#include "simulate/render/optics/arc_area.h"

namespace grainfield::simulate {

namespace {

int floor_to_int(double x) {
    return static_cast<int>(std::floor(x));
}

}  // namespace

bool DiscScan::prepare(const Disc& disc, int width, int y_first, int y_end) {
    disc_ = disc;
    const double radius = disc.radius;
    const auto [cx, cy] = disc.centre;
    if (!(radius > 0) || cx + radius < -0.5 || cx - radius > width || cy + radius < y_first - 0.5 ||
        cy - radius > y_end) {
        return false;
    }
    left_ = std::max(0, floor_to_int(cx - radius + 0.5));
    first_ = left_;
    end_ = std::min(width, floor_to_int(cx + radius + 0.5) + 1);
    top_ = std::max(y_first, floor_to_int(cy - radius + 0.5));
    bottom_ = std::min(y_end, floor_to_int(cy + radius + 0.5) + 1);
    if (first_ >= end_ || top_ >= bottom_) return false;

    const int column_borders = end_ - left_ + 1;
    const int row_borders = bottom_ - top_ + 1;
    columns_.resize(static_cast<std::size_t>(column_borders));
    rows_.resize(static_cast<std::size_t>(row_borders));
    const std::size_t borders = columns_.size() + rows_.size();
    distance_.resize(3 * borders);
    double* const distance = distance_.data();
    double* const half = distance + borders;
    double* const area = half + borders;
    for (std::size_t j = 0; j < columns_.size(); ++j) {
        distance[j] = std::min(std::abs(left_ - 0.5 + static_cast<double>(j) - cx), radius);
    }
    double* const of_rows = distance + columns_.size();
    for (std::size_t j = 0; j < rows_.size(); ++j) {
        of_rows[j] = std::clamp(top_ - 0.5 + static_cast<double>(j) - cy, -radius, radius);
    }
    arc_areas(distance, borders, radius, half, area);
    // H(k) of the half chord k at u: H(k) + H(u) = k u + π R²/4.
    const double quarter = 0.25 * std::numbers::pi * radius * radius;
    for (std::size_t j = 0; j < columns_.size(); ++j) {
        const double u = distance[j];
        const bool is_left = left_ - 0.5 + static_cast<double>(j) < cx;
        columns_[j] = {u, half[j], half[j] * u + quarter - area[j], is_left ? -1.0 : 1.0};
    }
    row_origin_ = top_;
    for (std::size_t j = 0; j < rows_.size(); ++j) {
        const std::size_t i = columns_.size() + j;
        rows_[j] = {distance[i], half[i], area[i]};
    }
    return true;
}

DiscScan::Row DiscScan::row_at(int y) const {
    const auto index = static_cast<std::size_t>(y - row_origin_);
    const RowBorder& above = rows_[index];
    const RowBorder& below = rows_[index + 1];
    Row row{above.t, below.t, above.h, below.h, 0, 0, 0, 0};
    const bool holds_centre = above.t < 0 && below.t > 0;
    const double widest =
        holds_centre ? disc_.radius : std::max(above.half_chord, below.half_chord);
    // Where the row sticks out of the disc, a border was clipped and its chord is zero.
    const double narrowest = std::min(above.half_chord, below.half_chord);
    const double x = disc_.centre.x;
    row.first = std::max(first_, floor_to_int(x - widest + 0.5));
    row.end = std::min(end_, floor_to_int(x + widest + 0.5) + 1);
    row.full_first = std::max(first_, static_cast<int>(std::ceil(x - narrowest + 0.5)));
    row.full_end = std::min(end_, floor_to_int(x + narrowest - 0.5) + 1);
    row.first = std::min(row.first, row.end);
    if (row.full_first < row.full_end) {
        row.full_first = std::clamp(row.full_first, row.first, row.end);
        row.full_end = std::clamp(row.full_end, row.full_first, row.end);
    }
    return row;
}

}  // namespace grainfield::simulate
