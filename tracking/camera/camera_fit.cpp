#include "tracking/camera/camera_fit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"

namespace grainfield::tracking {
namespace {

constexpr std::size_t kViewsForCentre = 3;
constexpr double kCentreError = 0.01;     // of the width
constexpr double kFarthestCentre = 0.15;  // of the width
constexpr double kOutlier = 5;            // times the median distance
constexpr double kLeastOutlier = 0.05;    // px
constexpr int kRounds = 5;
constexpr int kFlags =
    cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_ASPECT_RATIO | cv::CALIB_FIX_K3;

using Homography = std::array<double, 9>;

Homography array_of(const cv::Matx33d& m) {
    Homography h{};
    for (std::size_t i = 0; i < h.size(); ++i) h[i] = m.val[i] / m.val[8];
    return h;
}

cv::Matx33d matrix_of(const Homography& h) {
    return cv::Matx33d(h.data());
}

Vec2 middle_of(int width, int height) {
    return {0.5 * (width - 1), 0.5 * (height - 1)};
}

/// By a matrix without perspective.
Vec2 moved(const cv::Matx33d& m, Vec2 p) {
    const cv::Vec3d to = m * cv::Vec3d(p.x, p.y, 1);
    return {to[0], to[1]};
}

/// What calibrateCamera gives.
struct LensFit {
    double rms = std::numeric_limits<double>::infinity();
    Lens lens;
    Vec2 centre_error;
    std::vector<cv::Mat> turn, shift;  ///< pose of each view
};

struct Points {
    std::vector<std::vector<cv::Point3f>> place;
    std::vector<std::vector<cv::Point2f>> pixel;
};

Points points_of(const std::vector<BoardView>& views) {
    Points points;
    for (const BoardView& view : views) {
        auto& place = points.place.emplace_back();
        auto& pixel = points.pixel.emplace_back();
        for (std::size_t i = 0; i < view.pixel.size(); ++i) {
            place.emplace_back(static_cast<float>(view.place[i].x),
                               static_cast<float>(view.place[i].y), 0.0F);
            pixel.emplace_back(static_cast<float>(view.pixel[i].x),
                               static_cast<float>(view.pixel[i].y));
        }
    }
    return points;
}

LensFit lens_fit(const Points& points, cv::Size size, double focal, int flags) {
    const Vec2 middle = middle_of(size.width, size.height);
    cv::Mat matrix = (cv::Mat_<double>(3, 3) << focal, 0, middle.x, 0, focal, middle.y, 0, 0, 1);
    cv::Mat distortion = cv::Mat::zeros(5, 1, CV_64F);
    cv::Mat errors;
    LensFit fit;
    constexpr int iterations = 300;
    fit.rms =
        cv::calibrateCamera(points.place, points.pixel, size, matrix, distortion, fit.turn,
                            fit.shift, errors, cv::noArray(), cv::noArray(), flags,
                            {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, iterations, 1e-12});
    const auto number = [](const cv::Mat& m, int i) { return m.at<double>(i); };
    fit.lens = {.focal = matrix.at<double>(0, 0),
                .centre = {matrix.at<double>(0, 2), matrix.at<double>(1, 2)},
                .k1 = number(distortion, 0),
                .k2 = number(distortion, 1),
                .p1 = number(distortion, 2),
                .p2 = number(distortion, 3)};
    fit.centre_error = {number(errors, 2), number(errors, 3)};
    if (!std::isfinite(fit.rms) || !(fit.lens.focal > 0)) {
        fit.rms = std::numeric_limits<double>::infinity();
    }
    return fit;
}

/// From several focal lengths: a plane seen straight on hardly tells it.
LensFit best_lens(const Points& points, cv::Size size, int flags) {
    const double longer = std::max(size.width, size.height);
    LensFit best;
    for (const double focal : {1.2 * longer, 3 * longer, 10 * longer}) {
        LensFit fit = lens_fit(points, size, focal, flags);
        if (fit.rms < best.rms) best = std::move(fit);
    }
    return best;
}

/// Where the points of a view are seen by the fitted lens.
std::vector<Vec2> seen_by(const LensFit& fit, const Points& points, std::size_t view) {
    const Lens& lens = fit.lens;
    const cv::Matx33d matrix(lens.focal, 0, lens.centre.x, 0, lens.focal, lens.centre.y, 0, 0, 1);
    const cv::Vec4d distortion(lens.k1, lens.k2, lens.p1, lens.p2);
    std::vector<cv::Point2f> seen;
    cv::projectPoints(points.place[view], fit.turn[view], fit.shift[view], matrix, distortion,
                      seen);
    std::vector<Vec2> result;
    for (const cv::Point2f p : seen) {
        result.push_back({static_cast<double>(p.x), static_cast<double>(p.y)});
    }
    return result;
}

void require_usable(const BoardView& view, std::size_t index) {
    if (view.is_usable()) return;
    throw InputError({.problem = fmt::format("picture {} shows too little of a board", index),
                      .actual = fmt::format("{} points", view.pixel.size()),
                      .expected = "9 points, 3 columns, 3 rows or more",
                      .suggestion = "leave it out, or show more of the board"});
}

/// Views whose boards are not seen in a mirror: where the places are, they are turned over.
std::vector<BoardView> unmirrored(std::vector<BoardView> views) {
    for (BoardView& view : views) {
        const Points points = points_of({view});
        std::vector<cv::Point2f> place;
        for (const cv::Point3f& p : points.place.front()) place.emplace_back(p.x, p.y);
        const cv::Mat seen = cv::findHomography(place, points.pixel.front(), 0);
        if (seen.empty() || cv::determinant(seen) > 0) continue;
        for (Vec2& p : view.place) p.y *= -1;
    }
    return views;
}

/// The homography from what an ideal lens would see [px] to the board of the view [pitch].
cv::Matx33d plane_of(const BoardView& view, const Camera& camera) {
    std::vector<cv::Point2d> ideal;
    std::vector<cv::Point2d> place;
    for (std::size_t i = 0; i < view.pixel.size(); ++i) {
        const Vec2 p = CameraMap::unchecked(camera, view.pixel[i]).position;
        if (!is_finite(p)) continue;
        ideal.emplace_back(p.x, p.y);
        place.emplace_back(view.place[i].x, view.place[i].y);
    }
    const cv::Mat found = place.size() < 4 ? cv::Mat() : cv::findHomography(place, ideal, 0);
    if (found.empty()) {
        throw InputError({.problem = "no lens fits these points",
                          .actual = fmt::format("{} of {} could be without distortion",
                                                place.size(), view.pixel.size()),
                          .expected = "all of them",
                          .suggestion = "use sharper pictures of a flat board"});
    }
    return cv::Matx33d(found.ptr<double>()).inv();
}

/// Completes a camera whose homography is one to the plane [pitch or sides]: corrected pixels are
/// as large as those of the picture in the middle of the frame, which stays where it is; there the
/// picture is not turned, or, `is_aligned`, the axes of the plane are those of the result.
struct Corrected {
    double unit_per_px = 1;  ///< of the plane
    cv::Matx33d from_plane;
};
Corrected complete(Camera& camera, bool is_aligned = false) {
    const Vec2 middle = middle_of(camera.width, camera.height);
    const CameraMap::Corrected at = CameraMap::unchecked(camera, middle);
    const CameraMap::Jacobian& j = at.jacobian;
    Corrected result;
    result.unit_per_px = std::sqrt(std::abs(j.determinant()));
    const double angle = is_aligned ? 0 : std::atan2(j.yx - j.xy, j.xx + j.yy);
    const double c = std::cos(angle) / result.unit_per_px;
    const double s = std::sin(angle) / result.unit_per_px;
    result.from_plane = {c,  s, middle.x - c * at.position.x - s * at.position.y,
                         -s, c, middle.y + s * at.position.x - c * at.position.y,
                         0,  0, 1};
    camera.homography = array_of(result.from_plane * matrix_of(camera.homography));
    return result;
}

void require_possible(const Camera& camera) {
    if (const std::string fault = fault_of(camera); !fault.empty()) {
        throw InputError({.problem = "no lens and tilt fit these points",
                          .actual = fault,
                          .expected = "a map that is one to one over the whole frame",
                          .suggestion = "use pictures in which the board reaches the corners of "
                                        "the frame"});
    }
}

/// Whether a centre of its own lowers the squares by more than chance: each of its two numbers
/// must be worth ten of the squares that noise leaves. Few views do not tell it well, but the map
/// as a whole is better for it.
bool is_better(const LensFit& own, const LensFit& middle, const Points& points, cv::Size size) {
    double numbers = 0;
    for (const auto& view : points.pixel) numbers += 2 * static_cast<double>(view.size());
    const Vec2 off = own.lens.centre - middle_of(size.width, size.height);
    if (!(norm(off) < kFarthestCentre * size.width)) return false;
    constexpr double worth = 20;
    return 2 * numbers * std::log(middle.rms / own.rms) > worth;
}

/// The lens of all views that have points, and what is left over.
struct FittedViews {
    LensFit lens;
    bool is_centre_fitted = false;
    std::vector<BoardResidual> residuals;
};

FittedViews fit_lens(const std::vector<BoardView>& views, std::size_t cell_view, cv::Size size) {
    std::vector<BoardView> used;
    std::vector<std::size_t> number;
    for (std::size_t i = 0; i < views.size(); ++i) {
        if (views[i].empty() && i != cell_view) continue;
        require_usable(views[i], i);
        used.push_back(views[i]);
        number.push_back(i);
    }
    const Points points = points_of(used);
    FittedViews fit;
    fit.lens = best_lens(points, size, kFlags);
    const double largest = std::max(fit.lens.centre_error.x, fit.lens.centre_error.y);
    fit.is_centre_fitted = used.size() >= kViewsForCentre && largest < kCentreError * size.width;
    if (!fit.is_centre_fitted) {
        LensFit middle = best_lens(points, size, kFlags | cv::CALIB_FIX_PRINCIPAL_POINT);
        fit.is_centre_fitted = is_better(fit.lens, middle, points, size);
        if (!fit.is_centre_fitted) fit.lens = std::move(middle);
    }
    for (std::size_t v = 0; v < used.size(); ++v) {
        const std::vector<Vec2> seen = seen_by(fit.lens, points, v);
        for (std::size_t i = 0; i < seen.size(); ++i) {
            const Vec2 pixel = used[v].pixel[i];
            fit.residuals.push_back({number[v], pixel, pixel - seen[i]});
        }
    }
    return fit;
}

double median_of(std::vector<double> values) {
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, half);
    return *half;
}

/// Takes out what a fit leaves far from its place: views as a whole if there are any, whose points
/// were given wrong places and pull at all others; else single points. Gives their number.
std::int64_t drop_outliers(std::vector<BoardView>& views,
                           const std::vector<BoardResidual>& residuals) {
    std::vector<double> all;
    std::vector<std::vector<double>> distance(views.size());
    for (const BoardResidual& point : residuals) {
        all.push_back(norm(point.residual));
        distance[point.view].push_back(all.back());
    }
    const double largest = std::max(kOutlier * median_of(all), kLeastOutlier);
    std::int64_t dropped = 0;
    for (std::size_t v = 0; v < views.size(); ++v) {
        if (views[v].empty() || median_of(distance[v]) <= 0.5 * largest) continue;
        dropped += static_cast<std::int64_t>(views[v].pixel.size());
        views[v] = {};
    }
    if (dropped > 0) return dropped;
    for (std::size_t v = 0; v < views.size(); ++v) {
        BoardView kept;
        for (std::size_t i = 0; i < views[v].pixel.size(); ++i) {
            if (distance[v][i] > largest) continue;
            kept.pixel.push_back(views[v].pixel[i]);
            kept.place.push_back(views[v].place[i]);
        }
        dropped += static_cast<std::int64_t>(views[v].pixel.size() - kept.pixel.size());
        views[v] = std::move(kept);
    }
    return dropped;
}

}  // namespace

CameraFit fit_camera(const std::vector<BoardView>& found, std::size_t cell_view, int width,
                     int height, const std::optional<PlaneScale>& pitch) {
    for (std::size_t i = 0; i < found.size(); ++i) require_usable(found[i], i);
    std::vector<BoardView> views = unmirrored(found);
    const cv::Size size(width, height);
    CameraFit fit;
    FittedViews fitted = fit_lens(views, cell_view, size);
    for (int round = 0; round < kRounds; ++round) {
        const std::int64_t more = drop_outliers(views, fitted.residuals);
        if (more == 0) break;
        fit.dropped += more;
        fitted = fit_lens(views, cell_view, size);
    }
    fit.is_centre_fitted = fitted.is_centre_fitted;
    fit.residuals = std::move(fitted.residuals);

    Camera& camera = fit.camera;
    camera.width = width;
    camera.height = height;
    camera.lens = fitted.lens.lens;
    const BoardView& cell = views[cell_view];
    camera.homography = array_of(plane_of(cell, camera));
    const Corrected corrected = complete(camera);
    require_possible(camera);
    fit.pitch = 1 / corrected.unit_per_px;
    if (pitch) camera.scale = PlaneScale{corrected.unit_per_px * pitch->length, pitch->unit};

    const CameraMap map(camera);
    const Vec2 middle = middle_of(width, height);
    double squares = 0;
    std::size_t in_cell = 0;
    for (BoardResidual& point : fit.residuals) {
        if (point.view == cell_view) {
            const Vec2 there = moved(corrected.from_plane, cell.place[in_cell++]);
            point.residual = point.pixel - map.in_picture(there);
        }
        squares += squared_norm(point.residual);
        fit.reach = std::max(fit.reach, norm(point.pixel - middle) / norm(middle));
    }
    camera.residual_rms = std::sqrt(0.5 * squares / static_cast<double>(fit.residuals.size()));
    return fit;
}

Camera camera_of_rectangle(const std::array<Vec2, 4>& corners, double first_side,
                           double second_side, const std::optional<PlaneUnit>& unit, int width,
                           int height) {
    std::array<Vec2, 4> corner = corners;
    double across = first_side;
    double down = second_side;
    const auto turn = [&](std::size_t i) {
        const Vec2 in = corner[(i + 1) % 4] - corner[i];
        const Vec2 out = corner[(i + 2) % 4] - corner[(i + 1) % 4];
        return in.x * out.y - in.y * out.x;
    };
    if (turn(0) < 0) {  // around the other way
        std::swap(corner[1], corner[3]);
        std::swap(across, down);
    }
    for (std::size_t i = 0; i < 4; ++i) {
        if (!(turn(i) > 0)) {
            throw OptionError({.problem = "the corners are not those of a rectangle",
                               .actual = fmt::format("({:g}, {:g}) is not a corner that bulges out",
                                                     corner[(i + 1) % 4].x, corner[(i + 1) % 4].y),
                               .expected = "four corners in order around the cell",
                               .suggestion = "give them one after the other as x,y,x,y,…"});
        }
    }
    // The first side is the one that goes most to the right.
    std::size_t first = 0;
    for (std::size_t i = 1; i < 4; ++i) {
        const auto slope = [&](std::size_t k) {
            const Vec2 side = corner[(k + 1) % 4] - corner[k];
            return side.x / norm(side);
        };
        if (slope(i) > slope(first)) first = i;
    }
    std::rotate(corner.begin(), corner.begin() + first, corner.end());
    if (first % 2 == 1) std::swap(across, down);

    Camera camera;
    camera.width = width;
    camera.height = height;
    camera.lens.centre = middle_of(width, height);
    camera.lens.focal = std::max(width, height);
    std::vector<cv::Point2f> from;
    for (const Vec2 p : corner) from.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
    const auto w = static_cast<float>(across);
    const auto h = static_cast<float>(down);
    const std::vector<cv::Point2f> to{{0, 0}, {w, 0}, {w, h}, {0, h}};
    const cv::Mat to_plane = cv::getPerspectiveTransform(from, to);
    camera.homography = array_of(cv::Matx33d(to_plane.ptr<double>()));
    const Corrected corrected = complete(camera, true);
    require_possible(camera);
    if (unit) camera.scale = PlaneScale{corrected.unit_per_px, *unit};
    Box cell;
    cell.origin = moved(corrected.from_plane, {});
    cell.length = {across / corrected.unit_per_px, down / corrected.unit_per_px};
    camera.cell = cell;
    return camera;
}

}  // namespace grainfield::tracking
