#include "tracking/detect/local_maxima.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

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

}  // namespace

std::vector<Peak> local_maxima(const Image& map, float threshold, double separation) {
    std::vector<Peak> peaks;
    for (int y = 0; y < map.height(); ++y) {
        const float* row = map.row(y);
        for (int x = 0; x < map.width(); ++x) {
            if (row[x] > threshold && is_local_maximum(map, x, y, row[x])) {
                peaks.push_back(refine(map, x, y, row[x]));
            }
        }
    }
    std::sort(peaks.begin(), peaks.end(), [](const Peak& a, const Peak& b) {
        if (a.value != b.value) return a.value > b.value;
        if (a.position.y != b.position.y) return a.position.y < b.position.y;
        return a.position.x < b.position.x;
    });
    if (separation <= 1) return peaks;

    // Highest first onto a grid whose cells are one separation wide.
    const int columns = static_cast<int>(map.width() / separation) + 3;
    const int rows = static_cast<int>(map.height() / separation) + 3;
    std::vector<std::vector<std::uint32_t>> cells(static_cast<std::size_t>(columns) *
                                                  static_cast<std::size_t>(rows));
    std::vector<Peak> kept;
    for (const Peak& peak : peaks) {
        const int cx = static_cast<int>((peak.position.x + 1) / separation) + 1;
        const int cy = static_cast<int>((peak.position.y + 1) / separation) + 1;
        bool crowded = false;
        for (int y = std::max(0, cy - 1); y <= std::min(rows - 1, cy + 1) && !crowded; ++y) {
            for (int x = std::max(0, cx - 1); x <= std::min(columns - 1, cx + 1) && !crowded; ++x) {
                for (const std::uint32_t other :
                     cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                           static_cast<std::size_t>(x)]) {
                    if (squared_norm(kept[other].position - peak.position) <
                        separation * separation) {
                        crowded = true;
                        break;
                    }
                }
            }
        }
        if (crowded) continue;
        cells[static_cast<std::size_t>(std::min(cy, rows - 1)) * static_cast<std::size_t>(columns) +
              static_cast<std::size_t>(std::min(cx, columns - 1))]
            .push_back(static_cast<std::uint32_t>(kept.size()));
        kept.push_back(peak);
    }
    return kept;
}

}  // namespace grainfield::tracking
