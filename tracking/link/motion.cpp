#include "tracking/link/motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

std::vector<Vec2> velocities(const std::vector<Track>& tracks, Vec2 drift, double range) {
    std::vector<Vec2> velocity(tracks.size(), drift);
    std::vector<Vec2> place;
    std::vector<std::size_t> known;
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        if (!tracks[i].velocity) continue;
        velocity[i] = *tracks[i].velocity;
        place.push_back(tracks[i].position);
        known.push_back(i);
    }
    if (known.size() == tracks.size()) return velocity;
    const PointGrid grid(place, range);
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        if (tracks[i].velocity) continue;
        double nearest = range * range;
        grid.around(tracks[i].position, [&](std::uint32_t k, Vec2 p) {
            const double d2 = squared_norm(p - tracks[i].position);
            if (d2 > nearest) return;
            nearest = d2;
            velocity[i] = *tracks[known[k]].velocity;
        });
    }
    return velocity;
}

}  // namespace

std::vector<Vec2> predict(const std::vector<Track>& tracks, std::int64_t frame, Predictor predictor,
                          Vec2 drift, double range) {
    std::vector<Vec2> place(tracks.size());
    for (std::size_t i = 0; i < tracks.size(); ++i) place[i] = tracks[i].position;
    if (predictor == Predictor::none) return place;
    const std::vector<Vec2> velocity = predictor == Predictor::nearest_velocity
                                           ? velocities(tracks, drift, range)
                                           : std::vector<Vec2>(tracks.size(), drift);
    for (std::size_t i = 0; i < tracks.size(); ++i) {
        place[i] += static_cast<double>(frame - tracks[i].frame) * velocity[i];
    }
    return place;
}

Vec2 median(std::vector<Vec2> values) {
    if (values.empty()) return {};
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end(),
                     [](Vec2 a, Vec2 b) { return a.x < b.x; });
    const double x = middle->x;
    std::nth_element(values.begin(), middle, values.end(),
                     [](Vec2 a, Vec2 b) { return a.y < b.y; });
    return {x, middle->y};
}

double motion_variance(const std::vector<SeenStep>& steps) {
    constexpr std::size_t kSample = 1000;
    std::vector<SeenStep> sample;
    double high = 0;
    const std::size_t count = std::min(steps.size(), kSample);
    for (std::size_t k = 0; k < count; ++k) {
        // By golden sections: equal intervals could fall in step with an order of the particles.
        const double turn = std::fmod((static_cast<double>(k) + 0.5) / std::numbers::phi, 1.0);
        const std::size_t i =
            count == steps.size()
                ? k
                : static_cast<std::size_t>(turn * static_cast<double>(steps.size()));
        sample.push_back(steps[i]);
        high = std::max(high, steps[i].squared);
    }
    std::vector<double> ratio(sample.size());
    double low = 0;
    for (const double width = high; high - low > 1e-9 * width;) {
        const double variance = 0.5 * (low + high);
        std::transform(sample.begin(), sample.end(), ratio.begin(), [&](const SeenStep& s) {
            return s.squared / (variance + s.squared_errors);
        });
        const auto middle = ratio.begin() + static_cast<std::ptrdiff_t>(ratio.size() / 2);
        std::nth_element(ratio.begin(), middle, ratio.end());
        (*middle > 2 * std::numbers::ln2 ? low : high) = variance;
    }
    return low;
}

}  // namespace grainfield::tracking
