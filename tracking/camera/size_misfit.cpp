#include "tracking/camera/size_misfit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include <opencv2/core.hpp>

namespace grainfield::tracking {

namespace {

constexpr std::size_t kGroups = 10;
constexpr std::size_t kLeast = 10 * kGroups;
constexpr double kEdges = 0.1;  // that reach beyond a disc [D]

double median(std::vector<double> values) {
    const auto half = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, half);
    return *half;
}

/// Which discs have no other one so near that their edges meet. `reach`: of each, two of its radii;
/// `farthest`: the largest of them.
std::vector<bool> alone(const std::vector<Vec2>& position, const std::vector<double>& reach,
                        double farthest) {
    std::vector<std::size_t> order(position.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::ranges::sort(order, {}, [&](std::size_t j) { return position[j].x; });
    std::vector<bool> is_alone(position.size(), true);
    for (std::size_t a = 0; a < order.size(); ++a) {
        const Vec2 p = position[order[a]];
        for (std::size_t b = a + 1; b < order.size(); ++b) {
            const Vec2 d = position[order[b]] - p;
            if (d.x >= farthest) break;
            const double meeting = 0.5 * (reach[order[a]] + reach[order[b]]);
            if (!(norm(d) >= meeting)) is_alone[order[a]] = is_alone[order[b]] = false;
        }
    }
    return is_alone;
}

}  // namespace

std::vector<double> size_misfit(const CameraMap& map, const std::vector<Vec2>& position,
                                const std::vector<double>& residual, double diameter) {
    std::vector<double> share(position.size(), 0);
    if (!(diameter > 0)) return share;
    std::vector<double> size(position.size());
    std::vector<std::size_t> order;
    for (std::size_t j = 0; j < position.size(); ++j) {
        size[j] = 1 / std::sqrt(map.corrected(position[j]).jacobian.determinant());
        if (std::isfinite(size[j]) && std::isfinite(residual[j])) order.push_back(j);
    }
    if (order.size() < kLeast) return share;
    const auto by_size = [&](std::size_t j) { return size[j]; };
    std::ranges::sort(order, {}, by_size);
    const double per_size = (1 + kEdges) * diameter / size[order[order.size() / 2]];
    std::vector<double> reach = size;
    for (double& r : reach) r *= per_size;
    const std::vector<bool> is_alone = alone(position, reach, per_size * size[order.back()]);
    std::erase_if(order, [&](std::size_t j) { return !is_alone[j]; });
    if (order.size() < kLeast) return share;
    const double middle = size[order[order.size() / 2]];
    const double span = size[order.back()] - size[order.front()];
    if (!(span > 0)) return share;

    cv::Mat terms(kGroups, 3, CV_64F);
    cv::Mat squares(kGroups, 1, CV_64F);
    for (std::size_t g = 0; g < kGroups; ++g) {
        std::vector<double> sizes;
        std::vector<double> misfits;
        for (std::size_t i = g * order.size() / kGroups; i < (g + 1) * order.size() / kGroups;
             ++i) {
            sizes.push_back((size[order[i]] - middle) / span);
            misfits.push_back(residual[order[i]] * residual[order[i]]);
        }
        const auto row = static_cast<int>(g);
        const double s = median(std::move(sizes));
        terms.at<double>(row, 0) = 1;
        terms.at<double>(row, 1) = s;
        terms.at<double>(row, 2) = s * s;
        squares.at<double>(row) = median(std::move(misfits));
    }
    cv::Mat fitted;
    if (!cv::solve(terms, squares, fitted, cv::DECOMP_SVD)) return share;
    const double curvature = fitted.at<double>(2);
    if (!(curvature > 0)) return share;
    const double least = middle - span * fitted.at<double>(1) / (2 * curvature);
    if (least < size[order.front()] || least > size[order.back()]) return share;
    for (const std::size_t j : order) {
        const double off = (size[j] - least) / span;
        share[j] = curvature * off * off;
    }
    return share;
}

}  // namespace grainfield::tracking
