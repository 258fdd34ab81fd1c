#include "tracking/camera/board_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/image_mat.h"
#include "tracking/tracking.h"

namespace grainfield::tracking {
namespace {

constexpr double kOff = 0.2;         // of a step: farther is another point
constexpr int kLeastGrid = 3;        // corners a side
constexpr double kSmallSquare = 28;  // px: below, corners are better found on a larger picture
constexpr float kInSquare = 0.7F;    // of the way from the middle of a square to its corners
constexpr double kRight = 0.97;      // of the samples of a chessboard

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

/// Inner corners, row by row.
struct Corners {
    std::vector<cv::Point2f> point;  ///< [px]
    cv::Size size;                   ///< columns, rows

    cv::Point2f at(int column, int row) const {
        return point[static_cast<std::size_t>(row) * static_cast<std::size_t>(size.width) +
                     static_cast<std::size_t>(column)];
    }
};

/// On the picture made larger or smaller; empty if there are none.
Corners corners_of(const cv::Mat& bytes, cv::Size least, int flags, double scale) {
    cv::Mat scaled = bytes;
    if (scale != 1) {
        cv::resize(bytes, scaled, {}, scale, scale, scale > 1 ? cv::INTER_CUBIC : cv::INTER_AREA);
    }
    Corners corners;
    cv::Mat meta;
    if (!cv::findChessboardCornersSB(scaled, least, corners.point, flags, meta)) return {};
    corners.size = (flags & cv::CALIB_CB_LARGER) != 0 ? meta.size() : least;
    if (corners.size.area() != static_cast<int>(corners.point.size())) return {};
    const auto factor = static_cast<float>(1 / scale);
    for (cv::Point2f& p : corners.point) {
        p = {(p.x + 0.5F) * factor - 0.5F, (p.y + 0.5F) * factor - 0.5F};
    }
    return corners;
}

/// Least distance of neighbours in a row or column [px].
double least_step(const Corners& corners) {
    double least = std::numeric_limits<double>::infinity();
    for (int row = 0; row < corners.size.height; ++row) {
        for (int column = 0; column < corners.size.width; ++column) {
            const cv::Point2f here = corners.at(column, row);
            if (column > 0) least = std::min(least, cv::norm(here - corners.at(column - 1, row)));
            if (row > 0) least = std::min(least, cv::norm(here - corners.at(column, row - 1)));
        }
    }
    return least;
}

/// Whether the squares between the corners are evenly bright up to their corners, and bright and
/// dark by turns. Dots on a grid have saddles between them, too, but are round.
bool is_chessboard(const Image& counts, const Corners& corners) {
    std::vector<std::pair<double, bool>> samples;  // brightness, kind of square
    std::array<double, 2> sum{};                   // of the middles of squares
    std::array<double, 2> count{};
    bool is_inside = true;
    const auto brightness = [&](cv::Point2f p) {
        const int x = static_cast<int>(std::lround(p.x));
        const int y = static_cast<int>(std::lround(p.y));
        is_inside = is_inside && x >= 0 && y >= 0 && x < counts.width() && y < counts.height();
        return is_inside ? static_cast<double>(counts(x, y)) : 0.0;
    };
    for (int row = 0; row + 1 < corners.size.height; ++row) {
        for (int column = 0; column + 1 < corners.size.width; ++column) {
            const std::array<cv::Point2f, 4> around{
                corners.at(column, row), corners.at(column + 1, row),
                corners.at(column + 1, row + 1), corners.at(column, row + 1)};
            const cv::Point2f middle = 0.25F * (around[0] + around[1] + around[2] + around[3]);
            const bool is_odd = (row + column) % 2 == 1;
            sum[is_odd ? 1 : 0] += brightness(middle);
            ++count[is_odd ? 1 : 0];
            for (const cv::Point2f corner : around) {
                samples.emplace_back(brightness(middle + kInSquare * (corner - middle)), is_odd);
            }
        }
    }
    if (!is_inside || count[0] == 0 || count[1] == 0) return false;
    const double even = sum[0] / count[0];
    const double odd = sum[1] / count[1];
    const auto right = std::ranges::count_if(samples, [&](const auto& sample) {
        return (sample.first > 0.5 * (even + odd)) == (sample.second == (odd > even));
    });
    return static_cast<double>(right) >= kRight * static_cast<double>(samples.size());
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

bool BoardView::is_usable() const {
    constexpr std::size_t least = 9;
    std::set<double> columns;
    std::set<double> rows;
    for (const Vec2 p : place) {
        columns.insert(p.x);
        rows.insert(p.y);
    }
    return pixel.size() >= least && columns.size() >= kLeastGrid && rows.size() >= kLeastGrid;
}

BoardView find_chessboard(const Image& counts, const std::vector<std::int64_t>& columns_rows) {
    const cv::Mat bytes = eight_bit(counts);
    // What is allowed to be larger is sometimes found in part: a smaller picture may show more.
    Corners found;
    if (columns_rows.empty()) {
        const int flags = cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_LARGER;
        for (const double scale : {1.0, 0.5}) {
            Corners corners = corners_of(bytes, {kLeastGrid, kLeastGrid}, flags, scale);
            if (corners.point.size() > found.point.size() && is_chessboard(counts, corners)) {
                found = std::move(corners);
            }
        }
        if (found.point.empty()) return {};
    } else {
        found.size = {static_cast<int>(columns_rows.front()),
                      static_cast<int>(columns_rows.back())};
        found = corners_of(bytes, found.size, cv::CALIB_CB_EXHAUSTIVE, 1);
        if (found.point.empty() || !is_chessboard(counts, found)) return {};
    }
    const int flags = cv::CALIB_CB_EXHAUSTIVE | cv::CALIB_CB_ACCURACY |
                      (columns_rows.empty() ? cv::CALIB_CB_LARGER : 0);
    const double scale = least_step(found) < kSmallSquare ? 2 : 1;
    Corners fine = corners_of(bytes, found.size, flags, scale);
    if (fine.point.size() >= found.point.size() && is_chessboard(counts, fine)) {
        found = std::move(fine);
    }
    BoardView view;
    const auto columns = static_cast<std::size_t>(found.size.width);
    for (std::size_t i = 0; i < found.point.size(); ++i) {
        const std::size_t row = i / columns;
        const std::size_t column = i % columns;
        view.pixel.push_back(
            {static_cast<double>(found.point[i].x), static_cast<double>(found.point[i].y)});
        view.place.push_back({static_cast<double>(column), static_cast<double>(row)});
    }
    return view;
}

BoardView find_dots(const Image& counts, int threads) {
    const std::vector<Vec2> spots = locate(counts, {.threads = threads}).position;
    BoardView view = grid_order(spots);
    view.spots = spots.size();
    return view;
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
