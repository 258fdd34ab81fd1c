#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// Numbered points of an image in square cells, for "who is within this distance?". Points outside
/// the image count for the cell nearest to them, which is right as long as they lie less than one
/// cell outside.
class PointGrid {
 public:
    PointGrid(int width, int height, double distance)
        : distance_(std::max(distance, 1.0)),
          columns_(static_cast<int>(width / distance_) + 1),
          rows_(static_cast<int>(height / distance_) + 1),
          head_(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), kNone) {}

    void add(Vec2 p, std::uint32_t index) {
        std::uint32_t& head = head_[cell(column(p.x), row(p.y))];
        entries_.push_back({p, index, head});
        head = static_cast<std::uint32_t>(entries_.size() - 1);
    }

    std::size_t size() const { return entries_.size(); }

    /// Calls action(index, point) for every point nearer to p than `distance`, at most the grid's.
    template <class Action>
    void near(Vec2 p, double distance, Action&& action) const {
        const int c = column(p.x);
        const int r = row(p.y);
        for (int y = std::max(0, r - 1); y <= std::min(rows_ - 1, r + 1); ++y) {
            for (int x = std::max(0, c - 1); x <= std::min(columns_ - 1, c + 1); ++x) {
                for (std::uint32_t i = head_[cell(x, y)]; i != kNone; i = entries_[i].next) {
                    const Entry& e = entries_[i];
                    if (squared_norm(e.point - p) < distance * distance) action(e.index, e.point);
                }
            }
        }
    }

    bool any(Vec2 p, double distance) const {
        bool hit = false;
        near(p, distance, [&](std::uint32_t, Vec2) { hit = true; });
        return hit;
    }

 private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;
    struct Entry {
        Vec2 point;
        std::uint32_t index;
        std::uint32_t next;
    };

    int column(double x) const {
        return std::clamp(static_cast<int>(x / distance_), 0, columns_ - 1);
    }
    int row(double y) const { return std::clamp(static_cast<int>(y / distance_), 0, rows_ - 1); }
    std::size_t cell(int c, int r) const {
        return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(c);
    }

    double distance_;
    int columns_, rows_;
    std::vector<std::uint32_t> head_;
    std::vector<Entry> entries_;
};

}  // namespace grainfield::tracking
