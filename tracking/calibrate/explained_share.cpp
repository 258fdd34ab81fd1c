#include "tracking/calibrate/explained_share.h"

#include <algorithm>
#include <limits>
#include <numbers>

namespace grainfield::tracking {

double resolution_cell(double edge_width) {
    constexpr double kPerSquare = std::numbers::pi * std::numbers::pi * std::numbers::pi / 3;
    return std::max(1.0, kPerSquare * edge_width * edge_width);
}

ExplainedShare explained_share(const Image& darkness, const VisiblePixels& visible,
                               double residual_rms, double noise, const DiscProfile& disc,
                               std::size_t spheres) {
    double sum = 0;
    double squares = 0;
    double n = 0;
    for (int y = 0; y < darkness.height(); ++y) {
        for (int x = 0; x < darkness.width(); ++x) {
            if (!visible(x, y)) continue;
            const auto v = static_cast<double>(darkness(x, y));
            sum += v;
            squares += v * v;
            n += 1;
        }
    }
    ExplainedShare share;
    if (n == 0) return share;
    const double variance = squares / n - (sum / n) * (sum / n);
    const double misfit = residual_rms * residual_rms;
    const double white = noise * noise;
    if (variance > 0) share.all = 1 - misfit / variance;
    if (variance > white) share.signal = 1 - std::max(0.0, misfit - white) / (variance - white);
    const double values = n / resolution_cell(disc.edge_width);
    const double fitted = 2 * static_cast<double>(spheres);
    share.support = fitted > 0 ? values / fitted : std::numeric_limits<double>::infinity();
    if (values > fitted) {
        share.charged = std::max(0.0, 1 - (1 - share.signal) * values / (values - fitted));
    }
    return share;
}

}  // namespace grainfield::tracking
