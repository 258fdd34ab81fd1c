#include "tracking/synthesis/sphere_errors.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <Eigen/Dense>

#include "core/support/parallel.h"
#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

constexpr double kAbout = 0.6;  // [a]
constexpr int kLags = 3;
constexpr int kMostIterations = 80;
constexpr double kSolved = 1e-3;  // of the right side
constexpr std::uint64_t kSeed = 1;

// Overlaps of hard spheres.
constexpr double kWithinFrame = 1.5;  // [a]
constexpr double kMayOverlap = 1.3;   // [a] one step may bring them nearer than a diameter
constexpr double kCoincident = 0.1;   // [a]
constexpr std::size_t kLeastPairs = 60;
// Shares of the overlaps that lie below so many σ where errors are right.
constexpr std::pair<double, double> kOfRightErrors[] = {{0.6827, 0.77}, {0.9545, 1.70}};

using Vectors = std::vector<Eigen::Vector3d>;

double dot(const Vectors& a, const Vectors& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.size(); ++i) sum += a[i].dot(b[i]);
    return sum;
}

/// A · x.
void multiply(const SynthesisFit::Information& a, const Vectors& x, int threads, Vectors& result) {
    parallel_for(static_cast<std::int64_t>(x.size()), threads, [&](std::int64_t index) {
        const auto i = static_cast<std::size_t>(index);
        // Own blocks are symmetric.
        Eigen::Vector3d sum = Eigen::Map<const Eigen::Matrix3d>(a.own[i].data()) * x[i];
        for (const SynthesisFit::Block& block : a.pair[i]) {
            const Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>> value(
                block.value.data());
            sum += value.cast<double>() * x[static_cast<std::size_t>(block.other)];
        }
        result[i] = sum;
    });
}

/// The local RMS of an image, at least its median.
Image local_rms(const Image& residual, double radius, int threads) {
    Image squares(residual.width(), residual.height());
    for (std::size_t k = 0; k < squares.size(); ++k) {
        squares.pixels()[k] = residual.pixels()[k] * residual.pixels()[k];
    }
    // A Gaussian weighs as many pixels as a disc of twice its width in radius.
    Image rms = gaussian_blurred(squares, 0.5 * radius, threads);
    std::vector<float> sorted(rms.pixels().begin(), rms.pixels().end());
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    for (float& v : rms.pixels()) v = std::sqrt(std::max(v, *middle));
    return rms;
}

using Steps = std::vector<std::array<double, 3>>;

/// How all spheres would move under draws of noise like the residual, one after the other.
template <class Action>
void each_draw(const SynthesisFit& fit, const SynthesisFit::Information& info, int threads,
               Action&& action) {
    const Image spread = local_rms(fit.residual(), kAbout * fit.scale(), threads);
    const auto wide = static_cast<float>(std::sqrt(correlated_pixels(fit.residual())));
    RandomStream random(kSeed, "errors");
    Image noise(spread.width(), spread.height());
    for (int sample = 0; sample < kErrorSamples; ++sample) {
        for (std::size_t k = 0; k < noise.size(); ++k) {
            noise.pixels()[k] = wide * spread.pixels()[k] * static_cast<float>(random.normal());
        }
        action(joint_solution(info, fit.gradient_of(noise), threads));
    }
}

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

std::vector<std::array<double, 3>> joint_solution(const SynthesisFit::Information& a,
                                                  const std::vector<std::array<double, 3>>& b,
                                                  int threads) {
    const std::size_t n = b.size();
    std::vector<Eigen::Matrix3d> inverse(n);
    Vectors left(n);
    Vectors solution(n, Eigen::Vector3d::Zero());
    for (std::size_t i = 0; i < n; ++i) {
        left[i] = Eigen::Map<const Eigen::Vector3d>(b[i].data());
        inverse[i] = Eigen::Map<const Eigen::Matrix3d>(a.own[i].data()).inverse();
    }
    const auto preconditioned = [&] {
        Vectors scaled(n);
        for (std::size_t i = 0; i < n; ++i) scaled[i] = inverse[i] * left[i];
        return scaled;
    };
    Vectors direction = preconditioned();
    Vectors image(n);
    double squared = dot(left, direction);
    const double enough = kSolved * kSolved * squared;
    for (int k = 0; k < kMostIterations && squared > enough; ++k) {
        multiply(a, direction, threads, image);
        const double curvature = dot(direction, image);
        if (!(curvature > 0)) break;
        const double length = squared / curvature;
        for (std::size_t i = 0; i < n; ++i) {
            solution[i] += length * direction[i];
            left[i] -= length * image[i];
        }
        const Vectors scaled = preconditioned();
        const double now = dot(left, scaled);
        for (std::size_t i = 0; i < n; ++i) {
            direction[i] = scaled[i] + (now / squared) * direction[i];
        }
        squared = now;
    }
    std::vector<std::array<double, 3>> result(n);
    for (std::size_t i = 0; i < n; ++i) {
        result[i] = {solution[i].x(), solution[i].y(), solution[i].z()};
    }
    return result;
}

std::vector<SphereError> sphere_errors(SynthesisFit& fit, int threads) {
    const std::size_t n = fit.spheres().size();
    std::vector<SphereError> errors(n);
    if (n == 0) return errors;
    const SynthesisFit::Information info = fit.information();
    each_draw(fit, info, threads, [&](const Steps& step) {
        for (std::size_t i = 0; i < n; ++i) {
            errors[i].x += step[i][0] * step[i][0];
            errors[i].y += step[i][1] * step[i][1];
            errors[i].z += step[i][2] * step[i][2];
            errors[i].x_by_z += step[i][0] * step[i][2];
            errors[i].y_by_z += step[i][1] * step[i][2];
        }
    });
    for (std::size_t i = 0; i < n; ++i) {
        SphereError& e = errors[i];
        for (double* value : {&e.x, &e.y, &e.z}) *value = std::sqrt(*value / kErrorSamples);
        for (double* value : {&e.x_by_z, &e.y_by_z}) {
            *value = e.z > 0 ? *value / (kErrorSamples * e.z) : 0;
        }
        const SynthesisFit::LocalMisfit about = fit.misfit_about(i);
        e.residual = about.pixels > 0 ? std::sqrt(about.sum / about.pixels) : 0;
    }
    return errors;
}

double overlap_factor(SynthesisFit& fit, const std::vector<char>& is_doubtful, int threads) {
    const std::vector<Point3>& spheres = fit.spheres();
    const SynthesisFit::Information alone = fit.information(SynthesisFit::Contacts::ignored);
    struct Pair {
        std::size_t i, j;
        Eigen::Vector3d along;  ///< unit vector from j to i
        double distance;
        double in_plane = 0, in_height = 0;  ///< variances of the distance

        Eigen::Vector3d change(const Steps& step) const {
            const Eigen::Map<const Eigen::Vector3d> a(step[i].data());
            const Eigen::Map<const Eigen::Vector3d> b(step[j].data());
            return along.cwiseProduct(a - b);
        }
    };
    const double right = fit.residual().width() / fit.scale() - kWithinFrame;
    const double bottom = fit.residual().height() / fit.scale() - kWithinFrame;
    const auto at = [&](std::size_t i) {
        return Eigen::Vector3f(spheres[i].x, spheres[i].y, spheres[i].z).cast<double>().eval();
    };
    const auto counts = [&](std::size_t i, const Eigen::Vector3d& p) {
        return is_doubtful[i] == 0 && std::min(p.x(), p.y()) >= kWithinFrame && p.x() <= right &&
               p.y() <= bottom;
    };
    const Steps step = joint_solution(alone, alone.gradient, threads);
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        const Eigen::Vector3d p = at(i);
        if (!counts(i, p)) continue;
        const NearSpheres& near = fit.near(i);
        for (int k = 0; k < near.count; ++k) {
            if (near.id[k] <= static_cast<std::int32_t>(i)) continue;
            const auto j = static_cast<std::size_t>(near.id[k]);
            const Eigen::Vector3d apart = p - at(j);
            const double distance = apart.norm();
            if (distance > kMayOverlap || distance < kCoincident || !counts(j, at(j))) continue;
            Pair pair{i, j, apart / distance, distance};
            pair.distance += pair.change(step).sum();
            if (pair.distance < 1) pairs.push_back(pair);
        }
    }
    each_draw(fit, alone, threads, [&](const Steps& draw) {
        for (Pair& pair : pairs) {
            const Eigen::Vector3d change = pair.change(draw);
            const double plane = change.x() + change.y();
            pair.in_plane += plane * plane / kErrorSamples;
            pair.in_height += change.z() * change.z() / kErrorSamples;
        }
    });
    std::vector<double> overlaps;  // in standard errors
    for (const Pair& pair : pairs) {
        if (!(pair.in_height > pair.in_plane)) continue;
        overlaps.push_back((1 - pair.distance) / std::sqrt(pair.in_plane + pair.in_height));
    }
    if (overlaps.size() < kLeastPairs) return 1;
    double factor = 1;
    for (const auto& [share, expected] : kOfRightErrors) {
        const auto quantile = overlaps.begin() + static_cast<std::ptrdiff_t>(
                                                     share * static_cast<double>(overlaps.size()));
        std::nth_element(overlaps.begin(), quantile, overlaps.end());
        factor = std::max(factor, *quantile / expected);
    }
    return factor;
}

}  // namespace grainfield::tracking
