#include "tracking/detect/local_maxima.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

bool is_local_maximum(const Image& map, int x, int y, float value) {
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            if (dx == 0 && dy == 0) continue;
            const int nx = x + dx;
            const int ny = y + dy;
            if (nx < 0 || ny < 0 || nx >= map.width() || ny >= map.height()) continue;
            const float other = map(nx, ny);
            const bool before = dy < 0 || (dy == 0 && dx < 0);
            if (other > value || (before && other == value)) return false;
        }
    }
    return true;
}

/// Vertex of the parabola through (−1, left), (0, middle), (1, right), within ±0.5.
double vertex(float left, float middle, float right) {
    const double curvature =
        static_cast<double>(left) - 2.0 * static_cast<double>(middle) + static_cast<double>(right);
    if (curvature >= 0) return 0;
    return std::clamp(0.5 * (static_cast<double>(left) - static_cast<double>(right)) / curvature,
                      -0.5, 0.5);
}

Peak refine(const Image& map, int x, int y, float value) {
    Peak peak{{static_cast<double>(x), static_cast<double>(y)}, value};
    if (x > 0 && x + 1 < map.width()) {
        peak.position.x += vertex(map(x - 1, y), value, map(x + 1, y));
    }
    if (y > 0 && y + 1 < map.height()) {
        peak.position.y += vertex(map(x, y - 1), value, map(x, y + 1));
    }
    return peak;
}

/// Of two that are closer the first one stays.
std::vector<Peak> apart(const std::vector<Peak>& peaks, double separation) {
    std::vector<Vec2> places;
    for (const Peak& peak : peaks) places.push_back(peak.position);
    const PointGrid grid(places, separation);
    std::vector<char> stays(peaks.size(), 0);
    std::vector<Peak> kept;
    for (std::size_t k = 0; k < peaks.size(); ++k) {
        bool is_crowded = false;
        grid.near(places[k], separation,
                  [&](std::uint32_t other, Vec2) { is_crowded = is_crowded || stays[other] != 0; });
        if (is_crowded) continue;
        stays[k] = 1;
        kept.push_back(peaks[k]);
    }
    return kept;
}

}  // namespace

std::vector<Peak> local_maxima(const Image& map, float threshold, double separation) {
    constexpr int kTogether = 64;  // pixels of a row: most hold nothing
    std::vector<Peak> peaks;
    for (int y = 0; y < map.height(); ++y) {
        const float* row = map.row(y);
        for (int first = 0; first < map.width(); first += kTogether) {
            const int last = std::min(map.width(), first + kTogether);
            int above = 0;
#pragma omp simd reduction(+ : above)
            for (int x = first; x < last; ++x) above += row[x] > threshold ? 1 : 0;
            for (int x = first; above > 0 && x < last; ++x) {
                if (row[x] > threshold && is_local_maximum(map, x, y, row[x])) {
                    peaks.push_back(refine(map, x, y, row[x]));
                }
            }
        }
    }
    std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) {
        if (a.value != b.value) return a.value > b.value;
        if (a.position.y != b.position.y) return a.position.y < b.position.y;
        return a.position.x < b.position.x;
    });
    return separation > 1 ? apart(peaks, separation) : peaks;
}

}  // namespace grainfield::tracking
