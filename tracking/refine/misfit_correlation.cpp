#include "tracking/refine/misfit_correlation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

// Squared scores of 600 places tell their mean to 4 %. Large windows are fewer, for the time.
constexpr double kMostPlaces = 600;
constexpr double kLeastPlaces = 100;
constexpr double kMostProducts = 2e7;
constexpr double kMostExplained = 0.7;  // beyond it the first order says nothing
constexpr double kLeastMisfit = 0.05;   // of the residual's variance

/// ∂P/∂x and ∂P/∂y of a disc in the middle of a window.
struct Derivative {
    int reach = 0;
    int side = 0;
    std::vector<float> across, down;
    double squares = 0;  ///< Σ |J|²

    explicit Derivative(const DiscProfile& disc)
        : reach(static_cast<int>(std::ceil(disc.reach()))), side(2 * reach + 1) {
        for (int y = -reach; y <= reach; ++y) {
            for (int x = -reach; x <= reach; ++x) {
                const double r = std::hypot(x, y);
                const double slope = r > 0 ? disc.slope(r) / r : 0;
                across.push_back(static_cast<float>(slope * x));
                down.push_back(static_cast<float>(slope * y));
                squares += slope * slope * r * r;
            }
        }
    }

    double window() const { return static_cast<double>(side) * side; }

    /// a(Δ).
    double correlation(int dx, int dy) const {
        double sum = 0;
        for (int y = std::max(0, -dy); y < std::min(side, side - dy); ++y) {
            const auto here = static_cast<std::ptrdiff_t>(y) * side;
            const std::ptrdiff_t there = here + static_cast<std::ptrdiff_t>(dy) * side + dx;
            float row = 0;
            const int last = std::min(side, side - dx);
#pragma omp simd reduction(+ : row)
            for (int x = std::max(0, -dx); x < last; ++x) {
                row += across[static_cast<std::size_t>(here + x)] *
                           across[static_cast<std::size_t>(there + x)] +
                       down[static_cast<std::size_t>(here + x)] *
                           down[static_cast<std::size_t>(there + x)];
            }
            sum += static_cast<double>(row);
        }
        return sum;
    }

    /// Σ_Δ a(Δ)²/a(0)², on a grid of lags that is coarser for larger discs [px].
    double correlated_pixels() const {
        const double lags = std::clamp(kMostProducts / window(), kLeastPlaces, 4 * window());
        const int step = static_cast<int>(std::ceil(2 * side / std::sqrt(lags)));
        double sum = 0;
        for (int dy = -(2 * reach / step) * step; dy < side; dy += step) {
            for (int dx = -(2 * reach / step) * step; dx < side; dx += step) {
                const double a = correlation(dx, dy) / squares;
                sum += a * a;
            }
        }
        return sum * step * step;
    }
};

/// Of the finite ones; 0 without any.
double mean_square(const std::vector<double>& values) {
    double sum = 0;
    double n = 0;
    for (const double v : values) {
        if (!std::isfinite(v)) continue;
        sum += v * v;
        n += 1;
    }
    return n > 0 ? sum / n : 0;
}

}  // namespace

double misfit_correlation(const JointFit& fit, double noise, const JointFit::Residuals& left) {
    const DiscScene& scene = fit.scene();
    const int width = scene.darkness().width();
    const int height = scene.darkness().height();
    const std::vector<Vec2>& discs = fit.positions();
    const double white = noise * noise;
    const double about = std::max(mean_square(left.within_reach), mean_square(left.at_edge));
    if (!(about - white > kLeastMisfit * about)) return 1;

    const Derivative derivative(scene.disc());
    const int reach = derivative.reach;
    const double wanted =
        std::clamp(kMostProducts / derivative.window(), kLeastPlaces, kMostPlaces);
    const double diameter = scene.disc().diameter;
    RandomStream random(1, "misfit correlation");
    double scores = 0;
    double squares = 0;
    double places = 0;
    // Windows that the border or a mask cuts are drawn again, but not for ever.
    for (int draw = 0; places < wanted && draw < 4 * static_cast<int>(wanted); ++draw) {
        const auto i = std::min(
            discs.size() - 1,
            static_cast<std::size_t>(random.uniform() * static_cast<double>(discs.size())));
        const double right = (random.uniform() - 0.5) * diameter;
        const double down = (random.uniform() - 0.5) * diameter;
        if (!is_finite(discs[i])) continue;
        const int x0 = static_cast<int>(std::lround(discs[i].x + right)) - reach;
        const int y0 = static_cast<int>(std::lround(discs[i].y + down)) - reach;
        if (x0 < 0 || y0 < 0 || x0 + derivative.side > width || y0 + derivative.side > height) {
            continue;
        }
        double across = 0;
        double along = 0;
        double sum = 0;
        int hidden = 0;
        for (int v = 0; v < derivative.side; ++v) {
            const float* dark = scene.darkness().row(y0 + v) + x0;
            const float* through = scene.transmission().row(y0 + v) + x0;
            const auto first =
                static_cast<std::size_t>(v) * static_cast<std::size_t>(derivative.side);
            const float* jx = derivative.across.data() + first;
            const float* jy = derivative.down.data() + first;
            float row_x = 0;
            float row_y = 0;
            float row = 0;
#pragma omp simd reduction(+ : row_x, row_y, row, hidden)
            for (int u = 0; u < derivative.side; ++u) {
                const float r = dark[u] - 1.0F + through[u];
                row_x += jx[u] * r;
                row_y += jy[u] * r;
                row += r * r;
                hidden += through[u] > 0.0F ? 0 : 1;
            }
            across += static_cast<double>(row_x);
            along += static_cast<double>(row_y);
            sum += static_cast<double>(row);
        }
        if (hidden > 0) continue;
        scores += across * across + along * along;
        squares += sum;
        places += 1;
    }
    if (places < kLeastPlaces) return 1;
    const double mean = squares / (places * derivative.window());
    if (!(mean - white > kLeastMisfit * mean)) return 1;
    const double explained = 2 * static_cast<double>(discs.size()) / std::max(1.0, scene.pixels()) *
                             derivative.correlated_pixels();
    const double whole =
        scores / (places * derivative.squares) / (1 - std::min(explained, kMostExplained));
    return std::max(1.0, (whole - white) / (mean - white));
}

}  // namespace grainfield::tracking
