#include "tracking/camera/rectangle_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <opencv2/calib3d.hpp>

namespace grainfield::tracking {
namespace {

constexpr int kFocalLengths = 40;
constexpr double kShortest = 0.5, kLongest = 20;  // [longer side of the frame]
constexpr double kUsualMisfit = 0.003;            // likewise
constexpr double kUsualTilt = 15;                 // [°]
constexpr double kLargestMisfit = 0.01;           // [longer side of the frame]
constexpr double kLargestTilt = 35;               // [°]

double squared(double value) {
    return value * value;
}

/// Between the normal of the plane z = 0 and the line of sight to its origin [°].
double tilt_of(const cv::Mat& turn, const cv::Mat& shift) {
    cv::Mat rotation;
    cv::Rodrigues(turn, rotation);
    const cv::Mat normal = rotation.col(2);
    const double cosine = std::abs(normal.dot(shift)) / cv::norm(shift);
    return std::acos(std::min(cosine, 1.0)) * 180 / std::numbers::pi;
}

}  // namespace

RectangleView rectangle_view(const std::array<Vec2, 4>& corner, double first_side,
                             double second_side, int width, int height) {
    std::array<Vec2, 4> seen = corner;
    double area = 0;
    for (std::size_t i = 0; i < seen.size(); ++i) {
        const Vec2 next = seen[(i + 1) % seen.size()];
        area += seen[i].x * next.y - next.x * seen[i].y;
    }
    if (area < 0) {  // around the other way
        std::swap(seen[1], seen[3]);
        std::swap(first_side, second_side);
    }
    // About its middle, sides of about 1.
    const double unit = std::sqrt(first_side * second_side);
    const double x = 0.5 * first_side / unit;
    const double y = 0.5 * second_side / unit;
    const std::vector<cv::Point3d> place{{-x, -y, 0}, {x, -y, 0}, {x, y, 0}, {-x, y, 0}};
    std::vector<cv::Point2d> pixel;
    for (const Vec2 p : seen) pixel.emplace_back(p.x, p.y);

    const double longer = std::max(width, height);
    RectangleView best;
    best.misfit = best.tilt = best.doubt = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kFocalLengths; ++i) {
        const double share = static_cast<double>(i) / (kFocalLengths - 1);
        const double focal = longer * kShortest * std::pow(kLongest / kShortest, share);
        const cv::Matx33d camera(focal, 0, 0.5 * (width - 1), 0, focal, 0.5 * (height - 1), 0, 0,
                                 1);
        std::vector<cv::Mat> turns;
        std::vector<cv::Mat> shifts;
        cv::solvePnPGeneric(place, pixel, camera, cv::noArray(), turns, shifts, false,
                            cv::SOLVEPNP_IPPE);
        for (std::size_t pose = 0; pose < turns.size(); ++pose) {
            cv::solvePnPRefineLM(place, pixel, camera, cv::noArray(), turns[pose], shifts[pose]);
            std::vector<cv::Point2d> fitted;
            cv::projectPoints(place, turns[pose], shifts[pose], camera, cv::noArray(), fitted);
            double squares = 0;
            for (std::size_t k = 0; k < fitted.size(); ++k) {
                squares += squared(cv::norm(fitted[k] - pixel[k]));
            }
            RectangleView view;
            view.misfit = std::sqrt(squares / static_cast<double>(fitted.size()));
            view.tilt = tilt_of(turns[pose], shifts[pose]);
            view.doubt =
                squared(view.misfit / (kUsualMisfit * longer)) + squared(view.tilt / kUsualTilt);
            if (view.doubt < best.doubt) best = view;
        }
    }
    best.is_likely = best.misfit <= kLargestMisfit * longer && best.tilt <= kLargestTilt;
    return best;
}

}  // namespace grainfield::tracking
