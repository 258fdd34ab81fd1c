#include "tracking/score/position_score.h"

#include <algorithm>
#include <cmath>
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

double PositionScore::recall() const {
    return matched + missed > 0 ? static_cast<double>(matched) / (matched + missed) : 1.0;
}

double PositionScore::precision() const {
    return matched + spurious > 0 ? static_cast<double>(matched) / (matched + spurious) : 1.0;
}

PositionScore score_positions(const std::vector<Vec2>& found, const std::vector<Vec2>& truth,
                              double gate, int width, int height, double margin) {
    const auto inside = [&](Vec2 p) {
        return p.x >= margin && p.y >= margin && p.x <= width - 1 - margin &&
               p.y <= height - 1 - margin;
    };
    PositionScore result;
    result.partner = match_positions(found, truth, gate);
    std::vector<char> used(found.size(), 0);
    double squares = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const int j = result.partner[i];
        if (j >= 0) used[static_cast<std::size_t>(j)] = 1;
        if (!inside(truth[i])) continue;
        if (j < 0) {
            ++result.missed;
            continue;
        }
        const Vec2 error = found[static_cast<std::size_t>(j)] - truth[i];
        ++result.matched;
        squares += squared_norm(error);
        result.bias += error;
    }
    for (std::size_t j = 0; j < found.size(); ++j) {
        if (!used[j] && inside(found[j])) ++result.spurious;
    }
    if (result.matched > 0) {
        result.rms = std::sqrt(squares / (2.0 * result.matched));
        result.bias *= 1.0 / result.matched;
    }
    return result;
}

}  // namespace grainfield::tracking
