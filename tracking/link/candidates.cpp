#include "tracking/link/candidates.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace grainfield::tracking {
namespace {

/// A circle that holds so many particles is three spacings wide: beyond that no cost can tell who
/// is who, and memory must stay bounded.
constexpr std::size_t kMostPerTrack = 32;

}  // namespace

double StepCost::operator()(Vec2 step, Vec2 track_error, Vec2 particle_error) const {
    if (motion <= 0) return squared_norm(step);
    const double typical = motion + 2 * squared_error;
    const double x = motion + track_error.x * track_error.x + particle_error.x * particle_error.x;
    const double y = motion + track_error.y * track_error.y + particle_error.y * particle_error.y;
    return typical *
           (step.x * step.x / x + step.y * step.y / y + std::log(x * y / (typical * typical)));
}

TrackGrid::TrackGrid(const std::vector<Vec2>& points, double range) {
    if (points.empty()) return;
    Vec2 high = low_ = points[0];
    for (const Vec2 p : points) {
        low_ = {std::min(low_.x, p.x), std::min(low_.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    // Not more cells than a few per point, however small the range.
    const double extent = std::max({high.x - low_.x, high.y - low_.y, 1e-9});
    const double finest = extent / (2 * std::sqrt(static_cast<double>(points.size())) + 1);
    size_ = std::max(range, finest);
    columns_ = static_cast<std::int64_t>((high.x - low_.x) / size_) + 1;
    rows_ = static_cast<std::int64_t>((high.y - low_.y) / size_) + 1;
    first_.assign(static_cast<std::size_t>(columns_ * rows_) + 1, 0);
    std::vector<std::uint32_t> cell(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
        cell[i] = static_cast<std::uint32_t>(cell_of(points[i]));
        ++first_[cell[i] + 1];
    }
    for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
    order_.resize(points.size());
    auto next = first_;
    for (std::size_t i = 0; i < points.size(); ++i) {
        order_[next[cell[i]]++] = static_cast<std::uint32_t>(i);
    }
}

std::size_t TrackGrid::cell_of(Vec2 p) const {
    return static_cast<std::size_t>(static_cast<std::int64_t>((p.y - low_.y) / size_) * columns_ +
                                    static_cast<std::int64_t>((p.x - low_.x) / size_));
}

TrackGrid::Block TrackGrid::block(Vec2 p) const {
    const auto cell = [&](double offset, std::int64_t count) {
        // Predicted places may lie anywhere.
        const double c =
            std::clamp(std::floor(offset / size_), -2.0, static_cast<double>(count) + 1.0);
        return static_cast<std::int64_t>(c);
    };
    const std::int64_t column = cell(p.x - low_.x, columns_);
    const std::int64_t row = cell(p.y - low_.y, rows_);
    Block b{std::max<std::int64_t>(0, row - 1), std::min(rows_ - 1, row + 1),
            std::max<std::int64_t>(0, column - 1), std::min(columns_ - 1, column + 1)};
    if (b.first_column > b.last_column) b.last_row = b.first_row - 1;
    return b;
}

Candidates find_candidates(const Places& tracks, const Places& particles, double range,
                           const StepCost& cost) {
    const double range2 = range * range;
    const TrackGrid grid(particles.position, range);
    Candidates result;
    std::vector<AssignmentPair>& pairs = result.pairs;
    pairs.reserve(2 * tracks.position.size());
    for (std::size_t t = 0; t < tracks.position.size(); ++t) {
        const Vec2 from = tracks.position[t];
        const Vec2 track_error = tracks.error_of(t);
        const std::size_t begin = pairs.size();
        grid.near(from, [&](std::uint32_t p) {
            const Vec2 step = particles.position[p] - from;
            if (squared_norm(step) > range2) return;
            const double c = cost(step, track_error, particles.error_of(p));
            if (c <= range2) pairs.push_back({static_cast<std::uint32_t>(t), p, c});
        });
        if (pairs.size() - begin <= kMostPerTrack) continue;
        ++result.crowded_tracks;
        const auto first = pairs.begin() + static_cast<std::ptrdiff_t>(begin);
        std::nth_element(first, first + kMostPerTrack, pairs.end(),
                         [](const AssignmentPair& a, const AssignmentPair& b) {
                             return std::tie(a.cost, a.column) < std::tie(b.cost, b.column);
                         });
        pairs.resize(begin + kMostPerTrack);
    }
    return result;
}

}  // namespace grainfield::tracking
