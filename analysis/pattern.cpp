#include "analysis/pattern.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::analysis {

namespace {

// [a]; NaN where it is not known
double height_of(const Snapshot& snapshot, std::size_t i, double diameter) {
    const double z = snapshot.z[i] / diameter;
    const bool is_known =
        snapshot.z_error.empty() || snapshot.z_error[i] / diameter <= largest_height_error;
    return is_known && std::isfinite(z) ? z : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

Pattern pattern_of(const Snapshot& snapshot, double diameter) {
    const std::size_t n = snapshot.size();
    if (!snapshot.id.empty() && snapshot.id.size() != n) {
        throw InputError(ErrorText{fmt::format("frame {} is inconsistent", snapshot.frame),
                                   fmt::format("{} identities", snapshot.id.size()),
                                   fmt::format("{}, one per position", n), ""});
    }
    for (const auto* column : {&snapshot.z, &snapshot.z_error}) {
        if (column->empty() || column->size() == n) continue;
        throw InputError(ErrorText{fmt::format("frame {} is inconsistent", snapshot.frame),
                                   fmt::format("{} heights or errors of them", column->size()),
                                   fmt::format("{}, one per position", n), ""});
    }
    Pattern pattern;
    pattern.frame = snapshot.frame;
    pattern.time = snapshot.time;
    pattern.box = snapshot.box;
    pattern.box.origin = {snapshot.box.origin.x / diameter, snapshot.box.origin.y / diameter};
    pattern.box.length = {snapshot.box.length.x / diameter, snapshot.box.length.y / diameter};
    pattern.box.height = snapshot.box.height / diameter;
    require_valid(pattern.box);

    pattern.position.reserve(n);
    pattern.id.reserve(snapshot.id.size());
    for (std::size_t i = 0; i < n; ++i) {
        const Vec2 p{snapshot.position[i].x / diameter, snapshot.position[i].y / diameter};
        if (!is_finite(p)) {
            ++pattern.dropped;
            continue;
        }
        pattern.position.push_back(pattern.box.wrap(p));
        if (!snapshot.id.empty()) pattern.id.push_back(snapshot.id[i]);
        if (!snapshot.z.empty()) pattern.z.push_back(height_of(snapshot, i, diameter));
    }
    const auto is_known = [](double z) { return !std::isnan(z); };
    if (std::ranges::none_of(pattern.z, is_known)) pattern.z.clear();
    return pattern;
}

double diameter_of(const TrajectoryInfo& info) {
    if (!(info.diameter > 0) || !(info.diameter < 1e300)) {
        throw InputError(ErrorText{"the particle diameter of the trajectory is unusable",
                                   fmt::format("{}", info.diameter), "a positive number",
                                   "give the diameter when tracking or opening the points"});
    }
    return info.diameter;
}

}  // namespace grainfield::analysis
