#include "tracking/refine/edge_residuals.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace grainfield::tracking {
namespace {

// Of 2, 3, 4 and 5 as one over it, 3 and 4 fit errors of 64 cameras drawn at random best.
constexpr double kDiffer = 0.25;  // of the mean

}  // namespace

std::vector<double> edge_residuals(const JointFit::Residuals& left, double noise) {
    const double white = noise * noise;
    double sum = 0;
    double edges = 0;
    for (std::size_t j = 0; j < left.at_edge.size(); ++j) {
        if (!(left.edge_pixels[j] > 0)) continue;
        sum += left.at_edge[j] * left.at_edge[j];
        edges += 1;
    }
    const double mean = edges > 0 ? std::max(0.0, sum / edges - white) : 0;
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
