#include "tracking/refine/misfit_correlation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace grainfield::tracking {
namespace {

/// Products of two pixels that are summed: C(Δ) is known to a part in a hundred of C(0) or better.
constexpr double kMostProducts = 1.2e7;
constexpr double kMostExplained = 0.7;  // beyond it the first order says nothing
constexpr std::size_t kMostDiscs = 400;
constexpr double kLeastMisfit = 0.05;  // of the residual's variance

/// a(Δ) of ∂P/∂x and ∂P/∂y together, for −lags ≤ Δx ≤ lags and 0 ≤ Δy ≤ lags, row by row.
std::vector<double> derivative_correlation(const DiscProfile& disc, int lags) {
    const int reach = static_cast<int>(std::ceil(disc.reach()));
    const int side = 2 * reach + 1;
    std::vector<double> across(static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    std::vector<double> down(across.size());
    const auto at = [&](int x, int y) {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(side) +
               static_cast<std::size_t>(x);
    };
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            const double r = std::hypot(x - reach, y - reach);
            if (r == 0) continue;
            const double slope = disc.slope(r) / r;
            across[at(x, y)] = slope * (x - reach);
            down[at(x, y)] = slope * (y - reach);
        }
    }
    std::vector<double> correlation;
    for (int dy = 0; dy <= lags; ++dy) {
        for (int dx = -lags; dx <= lags; ++dx) {
            double sum = 0;
            for (int y = 0; y + dy < side; ++y) {
                for (int x = std::max(0, -dx); x < std::min(side, side - dx); ++x) {
                    sum += across[at(x, y)] * across[at(x + dx, y + dy)] +
                           down[at(x, y)] * down[at(x + dx, y + dy)];
                }
            }
            correlation.push_back(sum);
        }
    }
    return correlation;
}

void residual_row(const DiscScene& scene, int y, std::vector<float>& row) {
    const float* darkness = scene.darkness().row(y);
    const float* transmission = scene.transmission().row(y);
    for (std::size_t x = 0; x < row.size(); ++x) row[x] = darkness[x] - 1.0F + transmission[x];
}

}  // namespace

double misfit_at_edges(const JointFit& fit) {
    const DiscScene& scene = fit.scene();
    const int reach = static_cast<int>(std::ceil(scene.disc().reach()));
    const std::vector<Vec2>& discs = fit.positions();
    const std::size_t stride = std::max<std::size_t>(1, discs.size() / kMostDiscs);
    double at_edges = 0;
    double weights = 0;
    double squares = 0;
    double pixels = 0;
    for (std::size_t i = 0; i < discs.size(); i += stride) {
        const int cx = static_cast<int>(std::lround(discs[i].x));
        const int cy = static_cast<int>(std::lround(discs[i].y));
        const int x1 = std::min(scene.darkness().width() - 1, cx + reach);
        for (int y = std::max(0, cy - reach);
             y <= std::min(scene.darkness().height() - 1, cy + reach); ++y) {
            for (int x = std::max(0, cx - reach); x <= x1; ++x) {
                const double r = std::hypot(x - discs[i].x, y - discs[i].y);
                if (r > scene.disc().reach()) continue;
                const auto left = static_cast<double>(scene.darkness().row(y)[x] - 1.0F +
                                                      scene.transmission().row(y)[x]);
                const double slope = scene.disc().slope(r);
                at_edges += slope * slope * left * left;
                weights += slope * slope;
                squares += left * left;
                pixels += 1;
            }
        }
    }
    return squares > 0 ? at_edges * pixels / (weights * squares) : 1;
}

double misfit_correlation(const JointFit& fit, double noise) {
    const DiscScene& scene = fit.scene();
    const std::size_t discs = fit.positions().size();
    const int width = scene.darkness().width();
    const int height = scene.darkness().height();
    const int lags = static_cast<int>(std::ceil(scene.disc().diameter));
    if (width < 4 * lags || height < 4 * lags) return 1;
    const std::vector<double> weight = derivative_correlation(scene.disc(), lags);
    const double rows_wanted =
        kMostProducts / (static_cast<double>(weight.size()) * (width - 2 * lags));
    const int rows = std::clamp(static_cast<int>(rows_wanted), 1, height - lags);
    const double edges = misfit_at_edges(fit);
    std::vector<std::vector<float>> band(static_cast<std::size_t>(lags) + 1,
                                         std::vector<float>(static_cast<std::size_t>(width)));
    double own = 0;
    double all = 0;
    for (int k = 0; k < rows; ++k) {
        const int first = static_cast<int>(static_cast<std::int64_t>(k) * (height - lags) / rows);
        for (int dy = 0; dy <= lags; ++dy) {
            residual_row(scene, first + dy, band[static_cast<std::size_t>(dy)]);
        }
        const float* here = band.front().data() + lags;
        std::size_t term = 0;
        for (int dy = 0; dy <= lags; ++dy) {
            for (int dx = -lags; dx <= lags; ++dx, ++term) {
                if (dy == 0 && dx < 0) continue;
                const float* there = band[static_cast<std::size_t>(dy)].data() + lags + dx;
                float sum = 0;
#pragma omp simd reduction(+ : sum)
                for (int x = 0; x < width - 2 * lags; ++x) sum += here[x] * there[x];
                const double product = weight[term] * static_cast<double>(sum);
                const bool is_own = dy == 0 && dx == 0;
                if (is_own) own += product;
                all += is_own ? product : 2 * product;
            }
        }
    }
    double squares = 0;
    std::size_t term = 0;
    for (int dy = 0; dy <= lags; ++dy) {
        for (int dx = -lags; dx <= lags; ++dx, ++term) {
            squares += (dy == 0 ? 1 : 2) * weight[term] * weight[term];
        }
    }
    const double own_weight = weight[static_cast<std::size_t>(lags)];
    const double explained = 2 * static_cast<double>(discs) /
                             (static_cast<double>(width) * height) * squares /
                             (own_weight * own_weight);
    const double whole = edges * (1 + (all / own - 1) / (1 - std::min(explained, kMostExplained)));
    const double variance =
        own / (own_weight * static_cast<double>(rows) * static_cast<double>(width - 2 * lags));
    const double misfit = variance - noise * noise;
    if (!(misfit > kLeastMisfit * variance)) return 1;
    return std::max(1.0, (whole * variance - noise * noise) / misfit);
}

}  // namespace grainfield::tracking
