#include "tracking/refine/edge_residuals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

// 1/3 and 1/4 fit the errors of 64 cameras drawn at random best, of 1/2 to 1/5.
constexpr double kDiffer = 0.25;  // of the mean
constexpr double kUnusual = 10;   // medians: dust and false discs
// The mean of all counts as so many more edges of a kind. Chosen: a layer of 66 edges that meet
// others among 402 is described worse with 20.
constexpr double kLikeAll = 5;

/// Mean, the unusual left out.
double usual_mean(std::vector<double> squares) {
    if (squares.empty()) return 0;
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    const double most = kUnusual * *middle;
    double sum = 0;
    double n = 0;
    for (const double v : squares) {
        if (v > most) continue;
        sum += v;
        n += 1;
    }
    return n > 0 ? sum / n : 0;
}

/// m̄² of the edges of each kind, drawn to that of all where a kind has few.
std::array<double, kEdgeKinds> mean_misfits(const JointFit::Residuals& left,
                                            const std::vector<EdgeKind>& kinds, double white) {
    std::array<std::vector<double>, kEdgeKinds> squares;
    std::vector<double> all;
    for (std::size_t j = 0; j < left.at_edge.size(); ++j) {
        if (!(left.edge_pixels[j] > 0)) continue;
        all.push_back(left.at_edge[j] * left.at_edge[j]);
        squares[static_cast<std::size_t>(kinds[j])].push_back(all.back());
    }
    const double of_all = usual_mean(std::move(all));
    std::array<double, kEdgeKinds> means;
    for (std::size_t k = 0; k < kEdgeKinds; ++k) {
        const auto n = static_cast<double>(squares[k].size());
        const double mean =
            (n * usual_mean(std::move(squares[k])) + kLikeAll * of_all) / (n + kLikeAll);
        means[k] = std::max(0.0, mean - white);
    }
    return means;
}

}  // namespace

std::vector<EdgeKind> edge_kinds(const std::vector<Vec2>& discs, const DiscProfile& disc, int width,
                                 int height) {
    const double meet = 2 * disc.edge_reach();
    PointGrid grid(width, height, meet);
    for (std::size_t j = 0; j < discs.size(); ++j) {
        grid.add(discs[j], static_cast<std::uint32_t>(j));
    }
    std::vector<EdgeKind> kinds(discs.size(), EdgeKind::alone);
    for (std::size_t j = 0; j < discs.size(); ++j) {
        grid.near(discs[j], meet, [&](std::uint32_t other, Vec2) {
            if (other != j) kinds[j] = EdgeKind::meeting;
        });
    }
    return kinds;
}

double effective_noise(double noise, double correlation, double edge_residual, double harmless) {
    const double white = noise * noise;
    const double misfit = std::max(0.0, edge_residual * edge_residual - white - harmless);
    return std::sqrt(white + correlation * misfit);
}

std::vector<double> edge_residuals(const JointFit::Residuals& left,
                                   const std::vector<EdgeKind>& kinds, double noise) {
    const double white = noise * noise;
    const std::array<double, kEdgeKinds> means = mean_misfits(left, kinds, white);
    std::vector<double> steadied = left.within_reach;
    for (std::size_t j = 0; j < steadied.size(); ++j) {
        if (!(left.edge_pixels[j] > 0)) {
            if (!std::isfinite(steadied[j])) steadied[j] = noise;
            continue;
        }
        const double mean = means[static_cast<std::size_t>(kinds[j])];
        const double differ = kDiffer * mean * kDiffer * mean;
        const double misfit = left.at_edge[j] * left.at_edge[j] - white;
        const double uncertain = (2 * white * white + 4 * white * mean) / left.edge_pixels[j];
        const double share = uncertain > 0 ? uncertain / (uncertain + differ) : 0;
        steadied[j] = std::sqrt(std::max(0.0, white + (1 - share) * misfit + share * mean));
    }
    return steadied;
}

}  // namespace grainfield::tracking
