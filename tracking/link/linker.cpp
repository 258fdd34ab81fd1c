#include "tracking/link/linker.h"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace grainfield::tracking {
namespace {

struct Candidate {
    double squared_distance;
    std::uint32_t track;
    std::uint32_t particle;
    auto key() const { return std::tuple(squared_distance, track, particle); }
};

/// Particles sorted into square cells (counting sort), for range queries.
class CellGrid {
 public:
    CellGrid(const std::vector<Vec2>& points, double range) {
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
        for (const Vec2 p : points) ++first_[cell_of(p) + 1];
        for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
        order_.resize(points.size());
        auto next = first_;
        for (std::size_t i = 0; i < points.size(); ++i) {
            order_[next[cell_of(points[i])]++] = static_cast<std::uint32_t>(i);
        }
    }

    template <class Action>
    void near(Vec2 p, Action&& action) const {
        if (order_.empty()) return;
        const auto column = static_cast<std::int64_t>(std::floor((p.x - low_.x) / size_));
        const auto row = static_cast<std::int64_t>(std::floor((p.y - low_.y) / size_));
        for (auto y = std::max<std::int64_t>(0, row - 1); y <= std::min(rows_ - 1, row + 1); ++y) {
            for (auto x = std::max<std::int64_t>(0, column - 1);
                 x <= std::min(columns_ - 1, column + 1); ++x) {
                const auto c = static_cast<std::size_t>(y * columns_ + x);
                for (std::size_t i = first_[c]; i < first_[c + 1]; ++i) action(order_[i]);
            }
        }
    }

 private:
    std::size_t cell_of(Vec2 p) const {
        return static_cast<std::size_t>(static_cast<std::int64_t>((p.y - low_.y) / size_) *
                                            columns_ +
                                        static_cast<std::int64_t>((p.x - low_.x) / size_));
    }

    Vec2 low_;
    double size_ = 1;
    std::int64_t columns_ = 0, rows_ = 0;
    std::vector<std::size_t> first_;
    std::vector<std::uint32_t> order_;
};

}  // namespace

OptionTable describe(LinkOptions& options) {
    OptionTable table("link");
    table.number("search-range", options.search_range, "px", {0, 1e5},
                 "largest step between two frames");
    table.integer("memory", options.memory, "frames", {0, 100000},
                  "how long a sphere may be missing and keep its identity");
    return table;
}

Linker::Linker(double search_range, int memory) : search_range_(search_range), memory_(memory) {}

std::vector<std::int64_t> Linker::link(std::int64_t frame, const std::vector<Vec2>& positions) {
    const auto lost = [&](const Track& track) { return frame - track.frame > memory_ + 1; };
    summary_.ended += std::count_if(tracks_.begin(), tracks_.end(), lost);
    std::erase_if(tracks_, lost);
    const double range2 = search_range_ * search_range_;
    const CellGrid grid(positions, search_range_);
    std::vector<Candidate> candidates;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        grid.near(tracks_[t].position, [&](std::uint32_t particle) {
            const double d2 = squared_norm(positions[particle] - tracks_[t].position);
            if (d2 <= range2) candidates.push_back({d2, static_cast<std::uint32_t>(t), particle});
        });
    }
    std::sort(candidates.begin(), candidates.end(),
              [](const Candidate& a, const Candidate& b) { return a.key() < b.key(); });

    std::vector<std::int64_t> ids(positions.size(), -1);
    std::vector<char> taken(tracks_.size(), 0);
    for (const Candidate& c : candidates) {
        if (taken[c.track] || ids[c.particle] >= 0) continue;
        Track& track = tracks_[c.track];
        taken[c.track] = 1;
        ids[c.particle] = track.id;
        ++summary_.linked;
        if (frame - track.frame > 1) {
            ++summary_.bridged;
        } else {
            summary_.squared_steps += c.squared_distance;
            ++summary_.consecutive;
        }
        track.position = positions[c.particle];
        track.frame = frame;
    }
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (ids[i] >= 0) continue;
        ids[i] = next_id_++;
        tracks_.push_back({ids[i], frame, positions[i]});
        ++summary_.started;
    }
    return ids;
}

}  // namespace grainfield::tracking
