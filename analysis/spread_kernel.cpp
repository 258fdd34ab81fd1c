#include "analysis/spread_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

// The order of these matters.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/spread_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace grainfield::analysis::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, SpreadKernel::padding>;
using Vector = hn::Vec<Tag>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());

// `groups` of four cells hold the width of the kernel.
template <std::size_t groups>
HWY_INLINE void spread_groups(const SpreadKernel& kernel, std::span<const double> x,
                              std::span<const double> y, std::span<const double> weights,
                              double* HWY_RESTRICT tile) {
    constexpr std::size_t vectors = groups * SpreadKernel::padding / lanes;
    constexpr Tag tag;
    const double* HWY_RESTRICT coefficients = kernel.coefficients();
    const auto width = static_cast<std::size_t>(kernel.width());
    const double half = 0.5 * kernel.width();
    const double shift = static_cast<double>(SpreadTile::halo);
    HWY_ALIGN double of_rows[groups * SpreadKernel::padding];
    for (std::size_t j = 0; j < x.size(); ++j) {
        // The first cell that the kernel reaches, and where the particle stands from it.
        const double left = std::ceil(x[j] + shift - half);
        const double low = std::ceil(y[j] + shift - half);
        const auto tx = hn::Set(tag, 2 * (left - (x[j] + shift - half)) - 1);
        const auto ty = hn::Set(tag, 2 * (low - (y[j] + shift - half)) - 1);
        Vector kx[vectors];
        Vector ky[vectors];
        for (std::size_t v = 0; v < vectors; ++v) {
            kx[v] = ky[v] = hn::LoadU(tag, coefficients + v * lanes);
        }
        const double* next = coefficients;
        for (int power = 0; power < kernel.degree(); ++power) {
            next += groups * SpreadKernel::padding;
            for (std::size_t v = 0; v < vectors; ++v) {
                const auto c = hn::LoadU(tag, next + v * lanes);
                kx[v] = hn::MulAdd(kx[v], tx, c);
                ky[v] = hn::MulAdd(ky[v], ty, c);
            }
        }
        const auto weight = hn::Set(tag, weights.empty() ? 1.0 : weights[j]);
        for (std::size_t v = 0; v < vectors; ++v) {
            hn::Store(hn::Mul(ky[v], weight), tag, of_rows + v * lanes);
        }
        double* row = tile + static_cast<std::size_t>(low) * SpreadTile::columns +
                      static_cast<std::size_t>(left);
        for (std::size_t m = 0; m < width; ++m, row += SpreadTile::columns) {
            const auto of_row = hn::Set(tag, of_rows[m]);
            for (std::size_t v = 0; v < vectors; ++v) {
                double* at = row + v * lanes;
                hn::StoreU(hn::MulAdd(of_row, kx[v], hn::LoadU(tag, at)), tag, at);
            }
        }
    }
}

void spread_all(const SpreadKernel& kernel, std::span<const double> x, std::span<const double> y,
                std::span<const double> weights, double* tile) {
    switch (kernel.padded_width() / SpreadKernel::padding) {
        case 1:
            return spread_groups<1>(kernel, x, y, weights, tile);
        case 2:
            return spread_groups<2>(kernel, x, y, weights, tile);
        case 3:
            return spread_groups<3>(kernel, x, y, weights, tile);
        default:
            return spread_groups<4>(kernel, x, y, weights, tile);
    }
}

}  // namespace grainfield::analysis::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace grainfield::analysis {

HWY_EXPORT(spread_all);

namespace {

constexpr int nodes = 64;  // of the Chebyshev fits

// cos(π (i + ½)/n), i = 0 … n − 1.
double node(int i, int n) {
    return std::cos(std::numbers::pi * (i + 0.5) / n);
}

// Polynomial in t of the given degree, highest power first, through Chebyshev coefficients.
template <class Function>
std::vector<double> polynomial(int degree, Function&& f) {
    std::array<double, nodes> value;
    for (int i = 0; i < nodes; ++i) value[static_cast<std::size_t>(i)] = f(node(i, nodes));
    const auto size = static_cast<std::size_t>(degree) + 1;
    std::vector<double> power(size, 0.0);  // lowest first
    std::vector<double> before(size, 0.0);
    std::vector<double> current(size, 0.0);
    for (int k = 0; k <= degree; ++k) {
        std::vector<double> next(size, 0.0);
        if (k == 0) next[0] = 1;
        for (std::size_t p = 1; k > 0 && p < size; ++p) {
            next[p] = (k == 1 ? 1 : 2) * current[p - 1];
        }
        for (std::size_t p = 0; k > 1 && p < size; ++p) next[p] -= before[p];
        before = std::exchange(current, std::move(next));
        double c = 0;
        for (int i = 0; i < nodes; ++i) {
            c += value[static_cast<std::size_t>(i)] *
                 std::cos(std::numbers::pi * k * (i + 0.5) / nodes);
        }
        c *= (k == 0 ? 1.0 : 2.0) / nodes;
        for (std::size_t p = 0; p < size; ++p) power[p] += c * current[p];
    }
    std::ranges::reverse(power);
    return power;
}

}  // namespace

SpreadKernel::SpreadKernel(double tolerance) {
    const double digits = -std::log10(std::clamp(tolerance, 1e-15, 0.1));
    width_ = std::clamp(static_cast<int>(std::ceil(digits + 1.3)), 2, most_width);
    padded_ = (static_cast<std::size_t>(width_) + padding - 1) / padding * padding;
    degree_ = width_ + 3;
    beta_ = 2.3 * width_;
    coefficients_.assign((static_cast<std::size_t>(degree_) + 1) * padded_, 0.0);
    for (int m = 0; m < width_; ++m) {
        const auto c =
            polynomial(degree_, [&](double t) { return value(0.5 * (t + 1) - 0.5 * width_ + m); });
        for (std::size_t p = 0; p < c.size(); ++p) {
            coefficients_[p * padded_ + static_cast<std::size_t>(m)] = c[p];
        }
    }
}

double SpreadKernel::value(double z) const {
    const double u = 2 * z / width_;
    return u * u >= 1 ? (u * u > 1 + 1e-12 ? 0 : std::exp(-beta_))
                      : std::exp(beta_ * (std::sqrt(1 - u * u) - 1));
}

double SpreadKernel::transform(double frequency) const {
    // z = (w/2) sin θ takes the root's singularity at the ends away: the integrand is smooth and
    // periodic, the midpoint rule converges exponentially.
    constexpr int n = 128;
    double sum = 0;
    for (int i = 0; i < n; ++i) {
        const double angle = std::numbers::pi * ((i + 0.5) / n - 0.5);
        const double z = 0.5 * width_ * std::sin(angle);
        sum += std::exp(beta_ * (std::cos(angle) - 1)) * std::cos(frequency * z) * std::cos(angle);
    }
    return sum * std::numbers::pi / n * 0.5 * width_;
}

void spread(const SpreadKernel& kernel, std::span<const double> x, std::span<const double> y,
            std::span<const double> weights, SpreadTile& tile) {
    HWY_DYNAMIC_DISPATCH(spread_all)(kernel, x, y, weights, tile.value.data());
}

}  // namespace grainfield::analysis

#endif  // HWY_ONCE
