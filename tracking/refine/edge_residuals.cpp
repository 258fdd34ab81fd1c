#include "tracking/refine/edge_residuals.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace grainfield::tracking {
namespace {

// 1/3 and 1/4 fit the errors of 64 cameras drawn at random best, of 1/2 to 1/5.
constexpr double kDiffer = 0.25;  // of the mean
constexpr double kUnusual = 10;   // medians: dust and false discs

/// Of V, the unusual left out.
double usual_mean_square(const JointFit::Residuals& left) {
    std::vector<double> squares;
    for (std::size_t j = 0; j < left.at_edge.size(); ++j) {
        if (left.edge_pixels[j] > 0) squares.push_back(left.at_edge[j] * left.at_edge[j]);
    }
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

}  // namespace

double effective_noise(double noise, double correlation, double edge_residual, double harmless) {
    const double white = noise * noise;
    const double misfit = std::max(0.0, edge_residual * edge_residual - white - harmless);
    return std::sqrt(white + correlation * misfit);
}

std::vector<double> edge_residuals(const JointFit::Residuals& left, double noise) {
    const double white = noise * noise;
    const double mean = std::max(0.0, usual_mean_square(left) - white);
    const double differ = kDiffer * mean * kDiffer * mean;
    std::vector<double> steadied = left.within_reach;
    for (std::size_t j = 0; j < steadied.size(); ++j) {
        if (!(left.edge_pixels[j] > 0)) {
            if (!std::isfinite(steadied[j])) steadied[j] = noise;
            continue;
        }
        const double misfit = left.at_edge[j] * left.at_edge[j] - white;
        const double uncertain = (2 * white * white + 4 * white * mean) / left.edge_pixels[j];
        const double share = uncertain > 0 ? uncertain / (uncertain + differ) : 0;
        steadied[j] = std::sqrt(std::max(0.0, white + (1 - share) * misfit + share * mean));
    }
    return steadied;
}

}  // namespace grainfield::tracking
