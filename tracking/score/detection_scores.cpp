#include "tracking/score/detection_scores.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "tracking/point_grid.h"
#include "tracking/score/match_positions.h"
#include "tracking/score/share.h"

namespace grainfield::tracking {

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

/// The index of the point nearest to p; −1 if there are none.
int nearest_point(const std::vector<Vec2>& points, const PointGrid& grid, double range, Vec2 p) {
    int nearest = -1;
    double least = std::numeric_limits<double>::infinity();
    const auto consider = [&](std::uint32_t j, Vec2 point) {
        const double d2 = squared_norm(point - p);
        if (d2 < least || (d2 == least && static_cast<int>(j) < nearest)) {
            least = d2;
            nearest = static_cast<int>(j);
        }
    };
    grid.around(p, consider);
    if (nearest >= 0 && least <= range * range) return nearest;
    for (std::uint32_t j = 0; j < points.size(); ++j) consider(j, points[j]);
    return nearest;
}

void require_columns(const TruthFrame& truth, const std::vector<Vec2>& found,
                     const std::vector<Vec2>& errors) {
    const auto check = [](const char* what, std::size_t actual, std::size_t expected) {
        if (actual == expected) return;
        throw InputError({.problem = fmt::format("scores: {}", what),
                          .actual = std::to_string(actual),
                          .expected = std::to_string(expected),
                          .suggestion = {}});
    };
    check("classes of the true particles", truth.classes.size(), truth.position.size());
    if (!truth.bound.empty()) check("bounds", truth.bound.size(), truth.position.size());
    if (!errors.empty()) check("standard errors", errors.size(), found.size());
}

}  // namespace

double ClassScore::recall() const {
    return share(matched, matched + missed);
}

double ClassScore::precision() const {
    return share(matched, matched + spurious);
}

double ClassScore::jaccard() const {
    return share(matched, matched + missed + spurious);
}

Vec2 ClassScore::bias() const {
    const auto n = static_cast<double>(matched);
    return {share(error_sum.x, n), share(error_sum.y, n)};
}

Vec2 ClassScore::rmse() const {
    const auto n = static_cast<double>(matched);
    return {std::sqrt(share(square_sum.x, n)), std::sqrt(share(square_sum.y, n))};
}

double ClassScore::rmse_per_axis() const {
    return std::sqrt(share(square_sum.x + square_sum.y, 2 * static_cast<double>(matched)));
}

double ClassScore::bound() const {
    return std::sqrt(share(bound_squares, 2 * static_cast<double>(resolved)));
}

double ClassScore::bound_ratio() const {
    return std::sqrt(share(resolved_squares, bound_squares));
}

double ClassScore::pull_rms() const {
    return std::sqrt(share(pull_squares, static_cast<double>(pulls)));
}

double ClassScore::within_two_sigma() const {
    return share(static_cast<double>(pulls_within_two), static_cast<double>(pulls));
}

DetectionScores::DetectionScores(std::vector<std::string> classes, double gate) : gate_(gate) {
    if (classes.empty() || classes.size() > 64 || !(gate > 0) || !std::isfinite(gate)) {
        throw OptionError({.problem = "scores need 1 … 64 classes and a positive gate",
                           .actual = fmt::format("{} classes, gate {} px", classes.size(), gate),
                           .expected = {},
                           .suggestion = {}});
    }
    for (std::string& name : classes) {
        classes_.emplace_back();
        classes_.back().name = std::move(name);
    }
}

const ClassScore& DetectionScores::find(const std::string& name) const {
    const auto at = std::ranges::find(classes_, name, &ClassScore::name);
    if (at != classes_.end()) return *at;
    throw OptionError(
        {.problem = "no scores of this class", .actual = name, .expected = {}, .suggestion = {}});
}

bool DetectionScores::is_resolved(Vec2 bound) const {
    return bound.x > 0 && bound.y > 0 && std::max(bound.x, bound.y) < gate_ / 3;
}

void DetectionScores::add_match(ClassScore& score, Vec2 error, Vec2 bound, Vec2 reported) const {
    ++score.matched;
    score.error_sum += error;
    score.square_sum += {error.x * error.x, error.y * error.y};
    const bool bounds_known = !std::isinf(bound.x);
    if (bounds_known && !is_resolved(bound)) return;
    if (bounds_known) {
        ++score.resolved;
        score.resolved_squares += squared_norm(error);
        score.bound_squares += squared_norm(bound);
    }
    for (const auto& [e, sigma] : {std::pair{error.x, reported.x}, {error.y, reported.y}}) {
        if (!(sigma > 0) || !std::isfinite(sigma)) continue;
        ++score.pulls;
        score.pull_squares += e * e / (sigma * sigma);
        score.pulls_within_two += std::abs(e) <= 2 * sigma;
    }
}

void DetectionScores::add_phase(Vec2 truth, Vec2 error, Vec2 bound) {
    const bool bounds_known = !std::isinf(bound.x);
    if (bounds_known && !is_resolved(bound)) return;
    const auto add_axis = [&](std::size_t axis, double x, double e, double b) {
        const double phase = x - std::floor(x + 0.5) + 0.5;  // 0 … 1
        const auto bin = std::min<std::size_t>(
            kPhaseBins - 1, static_cast<std::size_t>(std::max(0.0, phase) * kPhaseBins));
        const double w = bounds_known ? 1 / (b * b) : 1;
        PhaseSums& sums = phase_[axis][bin];
        ++sums.count;
        sums.weight += w;
        sums.error += w * e;
        sums.weight2 += w * w;
        sums.weight2_error += w * w * e;
        sums.weight2_error2 += w * w * e * e;
    };
    add_axis(0, truth.x, error.x, bound.x);
    add_axis(1, truth.y, error.y, bound.y);
}

void DetectionScores::add_pulls(Vec2 error, Vec2 bound, Vec2 reported) {
    if (!std::isinf(bound.x) && !is_resolved(bound)) return;
    for (const auto& [e, sigma] : {std::pair{error.x, reported.x}, {error.y, reported.y}}) {
        if (!(sigma > 0) || !std::isfinite(sigma)) continue;
        const double place = (e / sigma / kLargestPull + 1) / 2 * kPullBins;
        if (place >= 0 && place < kPullBins) {
            ++pull_histogram_[static_cast<std::size_t>(place)];
        } else {
            ++pulls_beyond_;
        }
    }
}

FrameMatch DetectionScores::add(const TruthFrame& truth, const std::vector<Vec2>& found,
                                const std::vector<Vec2>& errors) {
    require_columns(truth, found, errors);
    ++frames_;
    FrameMatch match{match_positions(found, truth.position, gate_),
                     std::vector<std::uint64_t>(found.size(), 0)};
    const std::vector<int>& partner = match.partner;
    constexpr double kInfinite = std::numeric_limits<double>::infinity();
    const auto each_class = [&](std::uint64_t mask, auto&& action) {
        for (std::size_t c = 0; c < classes_.size(); ++c) {
            if ((mask >> c) & 1U) action(classes_[c]);
        }
    };
    std::vector<char> used(found.size(), 0);
    for (std::size_t i = 0; i < truth.position.size(); ++i) {
        const std::uint64_t mask = truth.classes[i];
        if (partner[i] < 0) {
            each_class(mask, [](ClassScore& score) { ++score.missed; });
            continue;
        }
        const auto j = static_cast<std::size_t>(partner[i]);
        used[j] = 1;
        match.classes[j] = mask;
        const Vec2 error = found[j] - truth.position[i];
        // An infinite bound stands for "not known".
        const Vec2 bound = truth.bound.empty() ? Vec2{kInfinite, kInfinite} : truth.bound[i];
        const Vec2 reported = errors.empty() ? Vec2{kNone, kNone} : errors[j];
        each_class(mask, [&](ClassScore& score) { add_match(score, error, bound, reported); });
        if ((mask & 1U) == 0) continue;
        add_phase(truth.position[i], error, bound);
        add_pulls(error, bound, reported);
    }
    const double range = 4 * gate_;
    const PointGrid grid(truth.position, range);
    for (std::size_t j = 0; j < found.size(); ++j) {
        if (used[j]) continue;
        const int nearest = nearest_point(truth.position, grid, range, found[j]);
        const std::uint64_t mask =
            nearest < 0 ? 1 : truth.classes[static_cast<std::size_t>(nearest)];
        match.classes[j] = mask;
        each_class(mask, [](ClassScore& score) { ++score.spurious; });
    }
    return match;
}

std::vector<PhaseBin> DetectionScores::phase_curve(int axis) const {
    std::vector<PhaseBin> curve;
    for (int b = 0; b < kPhaseBins; ++b) {
        const PhaseSums& sums = phase_[static_cast<std::size_t>(axis)][static_cast<std::size_t>(b)];
        PhaseBin bin{(b + 0.5) / kPhaseBins - 0.5, kNone, kNone};
        if (sums.count > 0) bin.mean = sums.error / sums.weight;
        if (sums.count > 1) {
            // Σ w² (e − mean)²: right whether or not the bounds are.
            const double m = bin.mean;
            const double scatter =
                sums.weight2_error2 - 2 * m * sums.weight2_error + m * m * sums.weight2;
            bin.error = std::sqrt(std::max(0.0, scatter)) / sums.weight;
        }
        curve.push_back(bin);
    }
    return curve;
}

DetectionScores::Locking DetectionScores::pixel_locking(int axis) const {
    // Evenly spaced bins make the harmonics orthogonal; sinc(1/bins) undoes the averaging in a bin.
    double a = 0;
    double b = 0;
    double variance = 0;
    double mean = 0;
    double squares = 0;
    for (const PhaseBin& bin : phase_curve(axis)) {
        if (!std::isfinite(bin.mean) || !std::isfinite(bin.error)) return {kNone, kNone, kNone};
        const double angle = 2 * std::numbers::pi * bin.phase;
        a += 2.0 / kPhaseBins * bin.mean * std::cos(angle);
        b += 2.0 / kPhaseBins * bin.mean * std::sin(angle);
        variance += bin.error * bin.error / kPhaseBins;
        mean += bin.mean / kPhaseBins;
        squares += bin.mean * bin.mean / kPhaseBins;
    }
    const double half = std::numbers::pi / kPhaseBins;
    const double averaging = std::sin(half) / half;
    const double scatter = squares - mean * mean - variance * (1 - 1.0 / kPhaseBins);
    return {std::hypot(a, b) / averaging, std::sqrt(2 * variance / kPhaseBins) / averaging,
            std::sqrt(std::max(0.0, scatter))};
}

}  // namespace grainfield::tracking
