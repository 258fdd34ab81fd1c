#include "tracking/synthesis/sphere_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <Eigen/Dense>

#include "core/support/parallel.h"

namespace grainfield::tracking {
namespace {

constexpr float kNeighbours = 1.35F;  // [a]
constexpr int kLags = 3;

}  // namespace

double correlated_pixels(const Image& residual) {
    double own = 0;
    double all = 0;
    for (int dy = -kLags; dy <= kLags; ++dy) {
        for (int dx = -kLags; dx <= kLags; ++dx) {
            double sum = 0;
            for (int y = kLags; y < residual.height() - kLags; y += 2) {
                const float* a = residual.row(y);
                const float* b = residual.row(y + dy) + dx;
                float row = 0;
#pragma omp simd reduction(+ : row)
                for (int x = kLags; x < residual.width() - kLags; ++x) row += a[x] * b[x];
                sum += static_cast<double>(row);
            }
            all += sum;
            if (dx == 0 && dy == 0) own = sum;
        }
    }
    return own > 0 ? std::max(1.0, all / own) : 1;
}

std::vector<SphereError> sphere_errors(SynthesisFit& fit, const SynthesisLimits& limits,
                                       int threads) {
    const std::size_t n = fit.spheres().size();
    std::vector<SphereError> errors(n);
    if (n == 0) return errors;
    const SynthesisFit::Information info = fit.information(limits);
    const double gain = fit.light().gain;
    std::vector<double> sorted(n);
    for (std::size_t i = 0; i < n; ++i) {
        const SynthesisFit::LocalMisfit about = fit.misfit_about(i);
        errors[i].residual = about.pixels > 0 ? std::sqrt(about.sum / about.pixels) : 0;
        sorted[i] = errors[i].residual;
    }
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double usual = *middle;
    const double correlated = correlated_pixels(fit.residual());
    parallel_for(static_cast<std::int64_t>(n), threads, [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        std::vector<std::size_t> member{i};
        for (const SynthesisFit::Block& block : info.pair[i]) {
            const auto j = static_cast<std::size_t>(block.other);
            const float x = fit.spheres()[j].x - fit.spheres()[i].x;
            const float y = fit.spheres()[j].y - fit.spheres()[i].y;
            if (x * x + y * y < kNeighbours * kNeighbours) member.push_back(j);
        }
        const auto size = static_cast<Eigen::Index>(3 * member.size());
        Eigen::MatrixXd a = Eigen::MatrixXd::Zero(size, size);
        for (std::size_t k = 0; k < member.size(); ++k) {
            const auto row = static_cast<Eigen::Index>(3 * k);
            a.block<3, 3>(row, row) =
                Eigen::Map<const Eigen::Matrix3d>(info.own[member[k]].data()).transpose();
            for (const SynthesisFit::Block& block : info.pair[member[k]]) {
                for (std::size_t l = 0; l < k; ++l) {
                    if (member[l] != static_cast<std::size_t>(block.other)) continue;
                    const auto column = static_cast<Eigen::Index>(3 * l);
                    for (Eigen::Index p = 0; p < 3; ++p) {
                        for (Eigen::Index q = 0; q < 3; ++q) {
                            const auto v = static_cast<double>(
                                block.value[static_cast<std::size_t>(3 * p + q)]);
                            a(row + p, column + q) = v;
                            a(column + q, row + p) = v;
                        }
                    }
                }
            }
        }
        const Eigen::MatrixXd first = Eigen::MatrixXd::Identity(size, 3);
        const Eigen::MatrixXd inverse = a.ldlt().solve(first);
        const double sigma = gain * std::max(usual, errors[i].residual);
        const auto error = [&](Eigen::Index p) {
            return sigma * std::sqrt(correlated * std::max(0.0, inverse(p, p)));
        };
        errors[i].x = error(0);
        errors[i].y = error(1);
        errors[i].z = error(2);
    });
    return errors;
}

}  // namespace grainfield::tracking
