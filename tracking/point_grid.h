#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec2.h"

namespace grainfield::tracking {

/// Numbered points in square cells, for searches by distance.
///
/// A search visits the nine cells around a place, O(1) at bounded density, row by row and from left
/// to right. In a cell, points of the constructor come in ascending order, added ones before them
/// and the last one first. Memory O(cells + points). Points must be finite.
class PointGrid {
 public:
    /// An empty grid over an image of width × height [px], for searches up to `distance` [px].
    /// Points outside the image count for the cell nearest to them: right as long as they lie less
    /// than one cell outside.
    PointGrid(int width, int height, double distance);

    /// All of `points`, numbered from zero, in cells over their bounding box, for searches up to
    /// `distance` > 0. About four cells a point at most, however short the distance.
    PointGrid(const std::vector<Vec2>& points, double distance);

    void add(Vec2 p, std::uint32_t index) {
        std::uint32_t& head = head_[cell(column(p.x), row(p.y))];
        entries_.push_back({p, index, head});
        head = static_cast<std::uint32_t>(entries_.size() - 1);
    }

    std::size_t size() const { return entries_.size(); }

    /// Calls action(index, point) for every point within the grid's distance of p, and for some
    /// farther away.
    template <class Action>
    void around(Vec2 p, Action&& action) const {
        const int c = column(p.x);
        const int r = row(p.y);
        for (int y = r > 0 ? r - 1 : 0; y <= r + 1 && y < rows_; ++y) {
            for (int x = c > 0 ? c - 1 : 0; x <= c + 1 && x < columns_; ++x) {
                for (std::uint32_t i = head_[cell(x, y)]; i != kNone; i = entries_[i].next) {
                    action(entries_[i].index, entries_[i].point);
                }
            }
        }
    }

    /// Calls action(index, point) for every point nearer to p than `distance`, at most the grid's.
    template <class Action>
    void near(Vec2 p, double distance, Action&& action) const {
        around(p, [&](std::uint32_t index, Vec2 point) {
            if (squared_norm(point - p) < distance * distance) action(index, point);
        });
    }

    bool any(Vec2 p, double distance) const {
        bool hit = false;
        near(p, distance, [&](std::uint32_t, Vec2) { hit = true; });
        return hit;
    }

    /// Calls action(i, j, squared distance) once for every two points nearer to each other than
    /// `distance`, at most the grid's.
    template <class Action>
    void each_pair(double distance, Action&& action) const {
        const double limit = distance * distance;
        const auto scan = [&](const Entry& one, std::uint32_t first) {
            for (std::uint32_t i = first; i != kNone; i = entries_[i].next) {
                const double square = squared_norm(entries_[i].point - one.point);
                if (square < limit) action(one.index, entries_[i].index, square);
            }
        };
        for (int y = 0; y < rows_; ++y) {
            for (int x = 0; x < columns_; ++x) {
                for (std::uint32_t i = head_[cell(x, y)]; i != kNone; i = entries_[i].next) {
                    const Entry& one = entries_[i];
                    scan(one, one.next);
                    if (x + 1 < columns_) scan(one, head_[cell(x + 1, y)]);
                    if (y + 1 == rows_) continue;
                    for (int u = x > 0 ? x - 1 : 0; u <= x + 1 && u < columns_; ++u) {
                        scan(one, head_[cell(u, y + 1)]);
                    }
                }
            }
        }
    }

 private:
    static constexpr std::uint32_t kNone = 0xFFFFFFFF;
    struct Entry {
        Vec2 point;
        std::uint32_t index;
        std::uint32_t next;  ///< in the same cell
    };

    /// Of a coordinate in cells, clamped to the grid.
    static int clamped(double cells, int count) {
        if (!(cells > 0)) return 0;
        return cells < count ? static_cast<int>(cells) : count - 1;
    }
    int column(double x) const { return clamped((x - low_.x) / size_, columns_); }
    int row(double y) const { return clamped((y - low_.y) / size_, rows_); }
    std::size_t cell(int c, int r) const {
        return static_cast<std::size_t>(r) * static_cast<std::size_t>(columns_) +
               static_cast<std::size_t>(c);
    }

    Vec2 low_;
    double size_ = 1;  ///< of a cell
    int columns_ = 1, rows_ = 1;
    std::vector<std::uint32_t> head_;  ///< first entry of each cell
    std::vector<Entry> entries_;
};

}  // namespace grainfield::tracking
