#include "tracking/score/match_positions.h"

#include <algorithm>
#include <cstdint>
#include <tuple>

#include "tracking/point_grid.h"

namespace grainfield::tracking {

std::vector<int> match_positions(const std::vector<Vec2>& found, const std::vector<Vec2>& truth,
                                 double gate) {
    const PointGrid grid(found, gate);
    std::vector<std::tuple<double, std::size_t, std::uint32_t>> pairs;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        grid.around(truth[i], [&](std::uint32_t j, Vec2 p) {
            const double d2 = squared_norm(p - truth[i]);
            if (d2 <= gate * gate) pairs.emplace_back(d2, i, j);
        });
    }
    std::sort(pairs.begin(), pairs.end());
    std::vector<int> partner(truth.size(), -1);
    std::vector<char> used(found.size(), 0);
    for (const auto& [d2, i, j] : pairs) {
        if (partner[i] >= 0 || used[j]) continue;
        partner[i] = static_cast<int>(j);
        used[j] = 1;
    }
    return partner;
}

}  // namespace grainfield::tracking
