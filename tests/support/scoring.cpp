#include "tests/support/scoring.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

namespace grainfield::testing {

double Score::recall() const {
    return matched + missed > 0 ? static_cast<double>(matched) / (matched + missed) : 1.0;
}

double Score::precision() const {
    return matched + spurious > 0 ? static_cast<double>(matched) / (matched + spurious) : 1.0;
}

Score score(const std::vector<Vec2>& found, const std::vector<Vec2>& truth, double gate, int width,
            int height, double margin) {
    const auto inside = [&](Vec2 p) {
        return p.x >= margin && p.y >= margin && p.x <= width - 1 - margin &&
               p.y <= height - 1 - margin;
    };
    const auto cell = [&](double v) { return static_cast<int>(std::floor(v / gate)); };
    std::map<std::pair<int, int>, std::vector<std::size_t>> cells;
    for (std::size_t j = 0; j < found.size(); ++j) {
        cells[{cell(found[j].x), cell(found[j].y)}].push_back(j);
    }
    std::vector<std::tuple<double, std::size_t, std::size_t>> pairs;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        for (int dy = -1; dy <= 1; ++dy) {
            for (int dx = -1; dx <= 1; ++dx) {
                const auto at = cells.find({cell(truth[i].x) + dx, cell(truth[i].y) + dy});
                if (at == cells.end()) continue;
                for (const std::size_t j : at->second) {
                    const double d2 = squared_norm(found[j] - truth[i]);
                    if (d2 <= gate * gate) pairs.emplace_back(d2, i, j);
                }
            }
        }
    }
    std::sort(pairs.begin(), pairs.end());
    Score result;
    result.partner.assign(truth.size(), -1);
    std::vector<char> used(found.size(), 0);
    double squares = 0;
    for (const auto& [d2, i, j] : pairs) {
        if (result.partner[i] >= 0 || used[j]) continue;
        result.partner[i] = static_cast<int>(j);
        used[j] = 1;
        if (!inside(truth[i])) continue;
        ++result.matched;
        squares += d2;
        result.bias += found[j] - truth[i];
    }
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (result.partner[i] < 0 && inside(truth[i])) ++result.missed;
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

}  // namespace grainfield::testing
