#include "tracking/layers/overlap_graph.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

void require_valid(const SphereCell& cell, const std::vector<Vec2>& positions,
                   const std::vector<Vec2>& errors, const OverlapOptions& options) {
    if (!(cell.diameter > 0) || !std::isfinite(cell.diameter)) {
        throw OptionError(ErrorText{"the sphere diameter must be positive",
                                    fmt::format("{} px", cell.diameter), "more than 0",
                                    "measure the sphere (track.sphere-diameter)"});
    }
    if (!(cell.height >= 1) || !std::isfinite(cell.height)) {
        throw OptionError(ErrorText{"the cell is lower than a sphere",
                                    fmt::format("height {} a", cell.height), "at least 1 a",
                                    "give the distance of the plates in sphere diameters"});
    }
    if (!(cell.camera_distance >= 0) || !std::isfinite(cell.camera_distance)) {
        throw OptionError(ErrorText{"the distance of the camera is out of range",
                                    fmt::format("{} a", cell.camera_distance),
                                    "more than 0, or 0 for a telecentric lens", ""});
    }
    if (!(options.significance >= 0) || !(options.label_significance >= options.significance)) {
        throw OptionError(ErrorText{"the significance of an overlap is out of range",
                                    fmt::format("{} for rejections, {} for labels",
                                                options.significance, options.label_significance),
                                    "0 or more, for labels not less than for rejections", ""});
    }
    if (!errors.empty() && errors.size() != positions.size()) {
        throw InputError(ErrorText{"positions and their errors differ in number",
                                   fmt::format("{} errors", errors.size()),
                                   fmt::format("{} or none", positions.size()), ""});
    }
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!is_finite(positions[i])) {
            throw InputError(
                ErrorText{fmt::format("the position of sphere {} is not finite", i), "", "", ""});
        }
    }
}

/// Standard error of the distance of two points [px].
double distance_error(Vec2 step, double distance, Vec2 one, Vec2 other) {
    const Vec2 variance{one.x * one.x + other.x * other.x, one.y * one.y + other.y * other.y};
    if (distance <= 0) return std::sqrt(std::max(variance.x, variance.y));
    const Vec2 along = (1 / distance) * step;
    return std::sqrt(variance.x * along.x * along.x + variance.y * along.y * along.y);
}

constexpr double kWrong = 1e-3;    // of the positions, altogether
constexpr int kFarthestError = 4;  // [σ]
constexpr int kStepsPerError = 2;

/// P(|z_i − z_j| ≥ rise) of two heights that are uniform within the same half of 0 … slack.
double alike_share(double rise, double slack) {
    const double part = std::max(0.0, 1 - 2 * rise / slack);
    return part * part;
}

/// The same of heights in opposite halves.
double opposite_share(double rise, double slack) {
    const double part = rise / slack;
    if (part >= 1) return 0;
    return part <= 0.5 ? 1 - 2 * part * part : 2 * (1 - part) * (1 - part);
}

}  // namespace

double opposite_log_odds(double distance, double error, double slack) {
    if (!(slack > 0)) return 0;
    double opposite = 0;
    double alike = 0;
    double sum = 0;
    const int steps = error > 0 ? kFarthestError * kStepsPerError : 0;
    for (int k = -steps; k <= steps; ++k) {
        const double errors = static_cast<double>(k) / kStepsPerError;
        const double weight = std::exp(-0.5 * errors * errors);
        const double rise = rise_at(std::max(0.0, distance + errors * error));
        opposite += weight * opposite_share(rise, slack);
        alike += weight * alike_share(rise, slack);
        sum += weight;
    }
    return std::log((kWrong + opposite / sum) / (kWrong + alike / sum));
}

OverlapGraph::OverlapGraph(const SphereCell& cell, const std::vector<Vec2>& positions,
                           const std::vector<Vec2>& errors, const OverlapOptions& options)
    : slack_(cell.slack()) {
    require_valid(cell, positions, errors, options);
    if (!positions.empty()) {
        pairs_.reserve(2 * positions.size());
        const auto add = [&](std::uint32_t one, std::uint32_t other, double square) {
            const auto [i, j] = std::minmax(one, other);
            const double distance = std::sqrt(square) / cell.diameter;
            double error = 0;
            if (!errors.empty()) {
                error = distance_error(positions[j] - positions[i], distance * cell.diameter,
                                       errors[i], errors[j]) /
                        cell.diameter;
                if (!std::isfinite(error)) return;
            }
            if (rise_at(distance) <= 0) return;
            const double parallax = cell.parallax(0.5 * (positions[i] + positions[j]));
            const double most = distance + parallax;
            // Perspective shifts a distance by anything between −parallax and +parallax.
            const double spread = std::hypot(error, parallax / std::sqrt(3.0));
            pairs_.push_back({i, j, rise_at(most + options.significance * error),
                              rise_at(most + options.label_significance * error), distance,
                              spread});
        };
        PointGrid(positions, cell.diameter).each_pair(cell.diameter, add);
    }
    link_pairs(positions.size());
}

OverlapGraph::OverlapGraph(double slack, std::size_t spheres, std::vector<OverlapPair> pairs)
    : slack_(slack), pairs_(std::move(pairs)) {
    link_pairs(spheres);
}

void OverlapGraph::link_pairs(std::size_t spheres) {
    first_link_.assign(spheres + 1, 0);
    for (const OverlapPair& pair : pairs_) {
        ++first_link_[pair.first + 1];
        ++first_link_[pair.second + 1];
    }
    for (std::size_t i = 0; i < spheres; ++i) first_link_[i + 1] += first_link_[i];
    links_.resize(2 * pairs_.size());
    auto next = first_link_;
    for (std::size_t e = 0; e < pairs_.size(); ++e) {
        const auto pair = static_cast<std::uint32_t>(e);
        links_[next[pairs_[e].first]++] = {pairs_[e].second, pair};
        links_[next[pairs_[e].second]++] = {pairs_[e].first, pair};
    }
}

}  // namespace grainfield::tracking
