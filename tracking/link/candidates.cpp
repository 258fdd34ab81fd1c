#include "tracking/link/candidates.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

/// A circle that holds so many particles is three spacings wide: beyond that no cost can tell who
/// is who, and memory must stay bounded.
constexpr std::size_t kMostPerTrack = 32;

}  // namespace

double StepCost::operator()(Vec2 step, Vec2 track_error, Vec2 particle_error) const {
    if (motion <= 0) return squared_norm(step);
    const double typical = motion + 2 * squared_error;
    const double x = motion + track_error.x * track_error.x + particle_error.x * particle_error.x;
    const double y = motion + track_error.y * track_error.y + particle_error.y * particle_error.y;
    return typical *
           (step.x * step.x / x + step.y * step.y / y + std::log(x * y / (typical * typical)));
}

Candidates find_candidates(const Places& tracks, const Places& particles, double range,
                           const StepCost& cost) {
    const double range2 = range * range;
    const PointGrid grid(particles.position, range);
    Candidates result;
    std::vector<AssignmentPair>& pairs = result.pairs;
    pairs.reserve(2 * tracks.position.size());
    for (std::size_t t = 0; t < tracks.position.size(); ++t) {
        const Vec2 from = tracks.position[t];
        const Vec2 track_error = tracks.error_of(t);
        const std::size_t begin = pairs.size();
        grid.around(from, [&](std::uint32_t p, Vec2 place) {
            const Vec2 step = place - from;
            if (squared_norm(step) > range2) return;
            const double c = cost(step, track_error, particles.error_of(p));
            if (c <= range2) pairs.push_back({static_cast<std::uint32_t>(t), p, c});
        });
        if (pairs.size() - begin <= kMostPerTrack) continue;
        ++result.crowded_tracks;
        const auto first = pairs.begin() + static_cast<std::ptrdiff_t>(begin);
        std::nth_element(first, first + kMostPerTrack, pairs.end(),
                         [](const AssignmentPair& a, const AssignmentPair& b) {
                             return std::tie(a.cost, a.column) < std::tie(b.cost, b.column);
                         });
        pairs.resize(begin + kMostPerTrack);
    }
    return result;
}

}  // namespace grainfield::tracking
