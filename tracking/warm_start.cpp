#include "tracking/warm_start.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

/// Enough discs for their RMS step to within a few percent.
constexpr std::size_t kStepSample = 1000;

}  // namespace

double step_between(const std::vector<Vec2>& before, const std::vector<Vec2>& now,
                    double diameter) {
    if (before.empty() || now.empty()) return 0;
    const double range = 0.5 * diameter;
    const PointGrid grid(before, range);
    const std::size_t stride = (now.size() - 1) / kStepSample + 1;
    double squares = 0;
    std::size_t near = 0;
    std::size_t all = 0;
    for (std::size_t i = 0; i < now.size(); i += stride) {
        double nearest = range * range;
        grid.near(now[i], range, [&](std::uint32_t, Vec2 p) {
            nearest = std::min(nearest, squared_norm(p - now[i]));
        });
        ++all;
        if (nearest >= range * range) continue;
        squares += nearest;
        ++near;
    }
    return 2 * near < all ? diameter : std::sqrt(squares / static_cast<double>(near));
}

}  // namespace grainfield::tracking
