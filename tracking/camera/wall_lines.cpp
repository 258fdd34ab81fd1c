#include "tracking/camera/wall_lines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "core/image_mat.h"

namespace grainfield::tracking {

namespace {

constexpr double kLeastSegment = 0.02;  // of the shorter side of the frame
constexpr double kLeastCovered = 0.25;  // of the side of the frame
constexpr double kOnLine = 1.5;         // px
constexpr double kSteepest = 0.57735;   // tan 30°
constexpr int kStep = 2;                // px between edge points
constexpr double kNearCorner = 0.04;    // of a side, without edge points
constexpr int kAcross = 4;              // px to both sides of an edge
constexpr double kWindow = 1.5;         // px, of the weights about it
constexpr int kSteps = 6;               // to its middle
constexpr double kStepFactor = 1.3;     // the weights shorten a step
constexpr double kLeastRise = 0.975;    // of the whole step at a wall
constexpr double kMostUneven = 0.04;    // likewise, beside it
constexpr std::size_t kLeastPoints = 20;
constexpr double kRoughest = 0.5;   // px, RMS; a row of spheres is rougher
constexpr double kLeastKept = 0.1;  // of the points along a line
constexpr int kRounds = 5;
constexpr double kFar = 3 * 1.4826;       // median deviations
constexpr double kLeastDeviation = 0.02;  // px

enum Side : std::size_t { left, top, right, bottom };
constexpr std::array<const char*, 4> kNames{"left", "upper", "right", "lower"};

bool is_upright(std::size_t side) {
    return side == left || side == right;
}

/// across = offset + slope · along; `along` is y of upright lines, x of level ones.
struct Line {
    double offset = 0, slope = 0;

    double at(double along) const { return offset + slope * along; }
};

/// A stretch of an edge, in the coordinates of Line.
struct Segment {
    double from = 0, to = 0;        ///< along
    double at_from = 0, at_to = 0;  ///< across

    double length() const { return to - from; }
};

Line through(const Segment& s) {
    const double slope = (s.at_to - s.at_from) / s.length();
    return {s.at_from - slope * s.from, slope};
}

struct Candidate {
    Line line;
    double covered = 0;       ///< px
    double from = 0, to = 0;  ///< along
};

/// Counts from the darkest to the brightest hundredth in 8 bit, a little blurred.
cv::Mat for_detection(const Image& image) {
    std::vector<float> counts = image.pixels();
    const auto percentile = [&](double share) {
        const auto at = static_cast<std::ptrdiff_t>(share * static_cast<double>(counts.size() - 1));
        std::nth_element(counts.begin(), counts.begin() + at, counts.end());
        return static_cast<double>(counts[static_cast<std::size_t>(at)]);
    };
    const double low = percentile(0.01);
    const double high = std::max(percentile(0.99), low + 1e-9);
    cv::Mat bytes;
    as_mat(image).convertTo(bytes, CV_8U, 255 / (high - low), -255 * low / (high - low));
    cv::GaussianBlur(bytes, bytes, {}, 1);
    return bytes;
}

/// Those long enough, upright and level ones apart.
std::array<std::vector<Segment>, 2> segments_of(const Image& image) {
    std::vector<cv::Vec4f> found;
    cv::createLineSegmentDetector()->detect(for_detection(image), found);
    const double least = kLeastSegment * std::min(image.width(), image.height());
    std::array<std::vector<Segment>, 2> segments;
    for (const cv::Vec4f& f : found) {
        const auto number = [&](int i) { return static_cast<double>(f[i]); };
        const double dx = std::abs(number(2) - number(0));
        const double dy = std::abs(number(3) - number(1));
        if (std::hypot(dx, dy) < least) continue;
        Segment s;
        if (dx < kSteepest * dy) {
            s = {number(1), number(3), number(0), number(2)};
        } else if (dy < kSteepest * dx) {
            s = {number(0), number(2), number(1), number(3)};
        } else {
            continue;
        }
        if (s.from > s.to) {
            std::swap(s.from, s.to);
            std::swap(s.at_from, s.at_to);
        }
        segments[dx < dy ? 0 : 1].push_back(s);
    }
    return segments;
}

/// By least squares over the ends of segments, weighted with their length.
Line line_of(const std::vector<Segment>& segments) {
    double w = 0, x = 0, y = 0, xx = 0, xy = 0;
    for (const Segment& s : segments) {
        for (const auto& [along, across] : {std::pair{s.from, s.at_from}, {s.to, s.at_to}}) {
            const double weight = s.length();
            w += weight;
            x += weight * along;
            y += weight * across;
            xx += weight * along * along;
            xy += weight * along * across;
        }
    }
    const double slope = (w * xy - x * y) / (w * xx - x * x);
    return {(y - slope * x) / w, slope};
}

/// The segments that lie on a line, and how much of it they cover.
Candidate gathered(const Line& about, const std::vector<Segment>& all) {
    std::vector<Segment> on;
    for (const Segment& s : all) {
        if (std::abs(s.at_from - about.at(s.from)) < kOnLine &&
            std::abs(s.at_to - about.at(s.to)) < kOnLine) {
            on.push_back(s);
        }
    }
    Candidate candidate;
    candidate.line = on.empty() ? about : line_of(on);
    std::ranges::sort(on, {}, &Segment::from);
    double end = -1e9;
    for (const Segment& s : on) {
        candidate.covered += std::max(0.0, s.to - std::max(s.from, end));
        end = std::max(end, s.to);
    }
    if (!on.empty()) {
        candidate.from = on.front().from;
        candidate.to = end;
    }
    return candidate;
}

/// Where an upright and a level line cross.
Vec2 crossing(const Line& upright, const Line& level) {
    const double x =
        (upright.offset + upright.slope * level.offset) / (1 - upright.slope * level.slope);
    return {x, level.at(x)};
}

/// In order around the cell.
std::array<Vec2, 4> corners_of(const std::array<Line, 4>& line) {
    return {crossing(line[left], line[top]), crossing(line[right], line[top]),
            crossing(line[right], line[bottom]), crossing(line[left], line[bottom])};
}

/// The counts across a line, kAcross pixels to both sides of the one it is in, mean of three along
/// it. Pixels as they are: linear interpolation between them would shift edges by a sixtieth of
/// one.
struct Profile {
    int middle = 0;
    std::array<double, 2 * kAcross + 1> count{};
};

/// Empty outside of the image.
std::optional<Profile> profile_at(const Image& image, bool upright, int along, double across) {
    Profile profile;
    profile.middle = static_cast<int>(std::lround(across));
    const int width = upright ? image.width() : image.height();
    const int height = upright ? image.height() : image.width();
    if (profile.middle < kAcross || profile.middle + kAcross >= width || along < 1 ||
        along + 1 >= height) {
        return std::nullopt;
    }
    for (std::size_t k = 0; k < profile.count.size(); ++k) {
        const int c = profile.middle + static_cast<int>(k) - kAcross;
        for (int a = along - 1; a <= along + 1; ++a) {
            profile.count[k] += static_cast<double>(upright ? image(c, a) : image(a, c)) / 3;
        }
    }
    return profile;
}

/// Mean distance of the slope from `across`, weighted by a Gaussian of that width about it.
double middle_of_slope(const Profile& profile, double across, double window) {
    double sum = 0;
    double moment = 0;
    for (std::size_t k = 0; k + 1 < profile.count.size(); ++k) {
        const double place = profile.middle + static_cast<double>(k) - kAcross + 0.5 - across;
        const double weight = std::exp(-0.5 * place * place / (window * window));
        const double slope = weight * (profile.count[k + 1] - profile.count[k]);
        sum += slope;
        moment += slope * place;
    }
    return moment / sum;
}

struct EdgePoint {
    double along = 0, across = 0;
    double rise = 0;    ///< from the low to the high end of the profile [counts]
    double uneven = 0;  ///< largest change within the last two pixels at either end
};

/// The middle of the edge by the line: the first moment of the slope across, then that about which
/// the weighted slope is balanced. The weights keep out the noise of the ends and spheres beside
/// the wall. Empty where there is none.
std::optional<EdgePoint> edge_at(const Image& image, bool upright, int along, double across) {
    constexpr double whole = 1e3;  // px: no weights
    EdgePoint point{.along = static_cast<double>(along), .across = across};
    std::optional<Profile> profile;
    for (int step = 0; step <= kSteps; ++step) {
        profile = profile_at(image, upright, along, point.across);
        if (!profile) return std::nullopt;
        point.across += step == 0 ? middle_of_slope(*profile, point.across, whole)
                                  : kStepFactor * middle_of_slope(*profile, point.across, kWindow);
        if (!std::isfinite(point.across) || std::abs(point.across - across) > kAcross) {
            return std::nullopt;
        }
    }
    const auto& count = profile->count;
    const auto change = [&](std::size_t a, std::size_t b) { return std::abs(count[a] - count[b]); };
    constexpr std::size_t last = 2 * kAcross;
    point.rise = count.back() - count.front();
    point.uneven = std::max({change(0, 1), change(0, 2), change(last, last - 1)});
    point.uneven = std::max(point.uneven, change(last, last - 2));
    return point;
}

double median(std::vector<double> values) {
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, half);
    return *half;
}

/// The points between two places along a line.
std::vector<EdgePoint> points_on(const Image& image, bool upright, const Line& line, double from,
                                 double to) {
    const double margin = kNearCorner * (to - from);
    std::vector<EdgePoint> points;
    std::vector<double> rises;
    const int end = static_cast<int>(std::ceil(to - margin));
    for (int along = static_cast<int>(std::ceil(from + margin)); along < end; along += kStep) {
        const auto point = edge_at(image, upright, along, line.at(along));
        if (!point) continue;
        points.push_back(*point);
        rises.push_back(point->rise);
    }
    if (rises.empty()) return points;
    // Where a sphere is near the wall, the step is a lower one, and the profile is not level.
    const double sign = median(rises) < 0 ? -1 : 1;
    for (double& rise : rises) rise *= sign;
    const auto high =
        rises.begin() + static_cast<std::ptrdiff_t>(0.9 * static_cast<double>(rises.size() - 1));
    std::ranges::nth_element(rises, high);
    const double whole = *high;
    std::erase_if(points, [&](const EdgePoint& p) {
        return !(sign * p.rise > kLeastRise * whole) || p.uneven > kMostUneven * whole;
    });
    return points;
}

struct FittedLine {
    Line line;
    double squares = 0;
    int points = 0;
};

FittedLine fitted(const std::vector<EdgePoint>& points) {
    FittedLine result;
    double most = 1e9;
    for (int round = 0; round < kRounds; ++round) {
        double n = 0, x = 0, y = 0, xx = 0, xy = 0;
        const auto is_in = [&](const EdgePoint& p) {
            return std::abs(p.across - result.line.at(p.along)) <= most;
        };
        for (const EdgePoint& p : points) {
            if (round > 0 && !is_in(p)) continue;
            ++n;
            x += p.along;
            y += p.across;
            xx += p.along * p.along;
            xy += p.along * p.across;
        }
        const double slope = (n * xy - x * y) / (n * xx - x * x);
        result.line = {(y - slope * x) / n, slope};
        std::vector<double> off;
        for (const EdgePoint& p : points) {
            off.push_back(std::abs(p.across - result.line.at(p.along)));
        }
        most = kFar * std::max(median(off), kLeastDeviation);
        result.points = 0;
        result.squares = 0;
        for (const EdgePoint& p : points) {
            if (!is_in(p)) continue;
            const double d = p.across - result.line.at(p.along);
            result.squares += d * d;
            ++result.points;
        }
    }
    return result;
}

bool is_straight_edge(const Image& image, bool upright, const Candidate& candidate) {
    const auto points = points_on(image, upright, candidate.line, candidate.from, candidate.to);
    if (points.size() < kLeastPoints) return false;
    const FittedLine fit = fitted(points);
    const double places = (candidate.to - candidate.from) / kStep;
    return fit.points >= kLeastKept * places &&
           std::sqrt(fit.squares / std::max(1, fit.points)) < kRoughest;
}

/// The innermost straight edge of that side that covers enough of the frame.
std::optional<Line> innermost(const Image& image, std::size_t side,
                              const std::vector<Segment>& all) {
    const bool upright = is_upright(side);
    const Vec2 middle{0.5 * (image.width() - 1), 0.5 * (image.height() - 1)};
    const double along = upright ? middle.y : middle.x;
    const double centre = upright ? middle.x : middle.y;
    const double least = kLeastCovered * (upright ? image.height() : image.width());
    const double sign = side == left || side == top ? -1 : 1;
    std::vector<std::pair<double, Candidate>> candidates;
    for (const Segment& seed : all) {
        const Candidate candidate = gathered(gathered(through(seed), all).line, all);
        const double distance = sign * (candidate.line.at(along) - centre);
        if (distance > 0 && candidate.covered >= least) {
            candidates.emplace_back(distance, candidate);
        }
    }
    std::ranges::sort(candidates, {}, &std::pair<double, Candidate>::first);
    for (const auto& [distance, candidate] : candidates) {
        if (is_straight_edge(image, upright, candidate)) return candidate.line;
    }
    return std::nullopt;
}

[[noreturn]] void refuse(const std::string& actual) {
    throw InputError({.problem = "the walls of the cell are not all seen",
                      .actual = actual,
                      .expected = "four straight edges about the middle of the frame, each seen "
                                  "along a quarter of the frame",
                      .suggestion = "show the whole cell, or give its corners with option "
                                    "'corners'"});
}

}  // namespace

CellWalls find_walls(const Image& image) {
    const auto segments = segments_of(image);
    std::array<Line, 4> line;
    std::string absent;
    for (std::size_t side = 0; side < line.size(); ++side) {
        const auto found = innermost(image, side, segments[is_upright(side) ? 0 : 1]);
        if (found) {
            line[side] = *found;
        } else {
            absent += fmt::format("{}{}", absent.empty() ? "" : ", ", kNames[side]);
        }
    }
    if (!absent.empty()) refuse("no edge of the " + absent + " wall");

    CellWalls walls;
    double squares = 0;
    for (int round = 0; round < 2; ++round) {
        const std::array<Vec2, 4> corner = corners_of(line);
        std::array<Line, 4> better = line;
        squares = 0;
        walls.points = 0;
        for (std::size_t side = 0; side < line.size(); ++side) {
            const bool upright = is_upright(side);
            // From corner to corner: 0 left top, 1 right top, 2 right bottom, 3 left bottom.
            constexpr std::array<std::pair<std::size_t, std::size_t>, 4> ends{
                {{0, 3}, {0, 1}, {1, 2}, {3, 2}}};
            const Vec2 from = corner[ends[side].first];
            const Vec2 to = corner[ends[side].second];
            const auto points = points_on(image, upright, line[side], upright ? from.y : from.x,
                                          upright ? to.y : to.x);
            if (points.size() < kLeastPoints) {
                refuse(fmt::format("{} points of the {} wall", points.size(), kNames[side]));
            }
            const FittedLine fit = fitted(points);
            better[side] = fit.line;
            squares += fit.squares;
            walls.points += fit.points;
        }
        line = better;
    }
    walls.corner = corners_of(line);
    walls.residual_rms = std::sqrt(squares / std::max(1, walls.points));
    return walls;
}

}  // namespace grainfield::tracking
