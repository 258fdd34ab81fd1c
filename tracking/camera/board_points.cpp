#include "tracking/camera/board_points.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <opencv2/calib3d.hpp>

#include "core/image_mat.h"
#include "tracking/tracking.h"

namespace grainfield::tracking {
namespace {

constexpr double kOff = 0.2;   // of a step: farther is another point
constexpr int kLeastGrid = 3;  // corners a side

/// 8 bit, from the 0.5 % to the 99.5 % quantile.
cv::Mat eight_bit(const Image& counts) {
    std::vector<float> sorted = counts.pixels();
    const auto at = [&](double share) {
        const auto place = sorted.begin() + static_cast<std::ptrdiff_t>(
                                                share * static_cast<double>(sorted.size() - 1));
        std::ranges::nth_element(sorted, place);
        return static_cast<double>(*place);
    };
    const double low = at(0.005);
    const double high = at(0.995);
    cv::Mat bytes;
    const double gain = high > low ? 255 / (high - low) : 1;
    as_mat(counts).convertTo(bytes, CV_8U, gain, -gain * low);
    return bytes;
}

using Place = std::pair<int, int>;

/// What is next to a point of the grid, and which way the grid goes there.
struct GridPoint {
    std::size_t index = 0;
    Vec2 right, down;  ///< steps to the neighbours [px]
};

std::optional<std::size_t> nearest(const std::vector<Vec2>& points, Vec2 p, double range) {
    double least = range * range;
    std::optional<std::size_t> found;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double d = squared_norm(points[i] - p);
        if (d >= least) continue;
        least = d;
        found = i;
    }
    return found;
}

/// The steps to two neighbours of a point, about at right angles; the first is nearer to +x.
std::optional<GridPoint> seed(const std::vector<Vec2>& points, std::size_t index) {
    std::vector<Vec2> steps;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (i != index) steps.push_back(points[i] - points[index]);
    }
    if (steps.size() < 2) return std::nullopt;
    std::ranges::sort(steps, {}, [](Vec2 step) { return squared_norm(step); });
    const Vec2 first = steps.front();
    constexpr double across = 0.4;  // largest |cos| of the two
    for (std::size_t i = 1; i < std::min<std::size_t>(steps.size(), 8); ++i) {
        const Vec2 second = steps[i];
        if (std::abs(dot(first, second)) > across * norm(first) * norm(second)) continue;
        Vec2 right = std::abs(first.x) > std::abs(first.y) ? first : second;
        Vec2 down = std::abs(first.x) > std::abs(first.y) ? second : first;
        if (right.x < 0) right *= -1;
        if (down.y < 0) down *= -1;
        return GridPoint{index, right, down};
    }
    return std::nullopt;
}

}  // namespace

BoardView find_chessboard(const Image& counts, const std::vector<std::int64_t>& columns_rows) {
    int flags = cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY;
    cv::Size size(kLeastGrid, kLeastGrid);
    if (columns_rows.empty()) {
        flags |= cv::CALIB_CB_LARGER;
    } else {
        size = {static_cast<int>(columns_rows.front()), static_cast<int>(columns_rows.back())};
    }
    std::vector<cv::Point2f> corners;
    cv::Mat meta;
    if (!cv::findChessboardCornersSB(eight_bit(counts), size, corners, flags, meta)) return {};
    if (columns_rows.empty()) size = meta.size();
    if (size.area() != static_cast<int>(corners.size())) return {};
    BoardView view;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const auto columns = static_cast<std::size_t>(size.width);
        view.pixel.push_back({corners[i].x, corners[i].y});
        view.place.push_back({static_cast<double>(i % columns), static_cast<double>(i / columns)});
    }
    return view;
}

BoardView find_dots(const Image& counts, int threads) {
    return grid_order(locate(counts, {.threads = threads}).position);
}

BoardView grid_order(const std::vector<Vec2>& points) {
    Vec2 middle;
    for (const Vec2 p : points) middle += (1.0 / static_cast<double>(points.size())) * p;
    const auto first = nearest(points, middle, std::numeric_limits<double>::infinity());
    const std::optional<GridPoint> start = first ? seed(points, *first) : std::nullopt;
    if (!start) return {};
    std::map<Place, GridPoint> grid{{{0, 0}, *start}};
    std::map<std::size_t, Place> taken{{start->index, {0, 0}}};
    std::set<std::size_t> doubtful;
    std::deque<Place> open{{0, 0}};
    while (!open.empty()) {
        const Place place = open.front();
        open.pop_front();
        const GridPoint here = grid.at(place);
        for (const auto& [dx, dy] : {Place{1, 0}, Place{-1, 0}, Place{0, 1}, Place{0, -1}}) {
            const Place next{place.first + dx, place.second + dy};
            if (grid.contains(next)) continue;
            const Vec2 step = dx * here.right + dy * here.down;
            const auto found = nearest(points, points[here.index] + step, kOff * norm(step));
            if (!found) continue;
            if (const auto known = taken.find(*found); known != taken.end()) {
                if (known->second != next) doubtful.insert(*found);
                continue;
            }
            GridPoint there{*found, here.right, here.down};
            const Vec2 seen = points[*found] - points[here.index];
            if (dx != 0) there.right = static_cast<double>(dx) * seen;
            if (dy != 0) there.down = static_cast<double>(dy) * seen;
            grid.emplace(next, there);
            taken.emplace(*found, next);
            open.push_back(next);
        }
    }
    BoardView view;
    for (const auto& [place, point] : grid) {
        if (doubtful.contains(point.index)) continue;
        view.pixel.push_back(points[point.index]);
        view.place.push_back({static_cast<double>(place.first), static_cast<double>(place.second)});
    }
    return view;
}

}  // namespace grainfield::tracking
