#include "tracking/score/position_bounds.h"

#include <cmath>
#include <limits>

#include "tracking/refine/joint_covariance.h"
#include "tracking/refine/joint_fit.h"
#include "tracking/refine/joint_information.h"

namespace grainfield::tracking {

std::vector<Vec2> position_bounds(const std::vector<Vec2>& positions, const DiscProfile& disc,
                                  int width, int height, double noise, int threads) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    JointFit fit(Image(width, height), disc, threads);
    std::vector<std::size_t> place;
    const double reach = disc.reach();
    for (std::size_t i = 0; i < positions.size(); ++i) {
        const Vec2 p = positions[i];
        if (p.x <= -reach || p.y <= -reach || p.x >= width - 1 + reach ||
            p.y >= height - 1 + reach) {
            continue;
        }
        place.push_back(i);
        fit.add(p);
    }
    std::vector<Vec2> bounds(positions.size(), {kNone, kNone});
    const auto covariance = joint_covariance(joint_information(fit), threads);
    for (std::size_t j = 0; j < place.size(); ++j) {
        bounds[place[j]] = {noise * std::sqrt(covariance[j].xx),
                            noise * std::sqrt(covariance[j].yy)};
    }
    return bounds;
}

}  // namespace grainfield::tracking
