#include "analysis/spectra/spread_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

// The order of these matters.
// clang-format off
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/spectra/spread_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// clang-format on

HWY_BEFORE_NAMESPACE();
namespace grainfield::analysis::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<double, SpreadKernel::padding>;
using Vector = hn::Vec<Tag>;
constexpr std::size_t lanes = hn::MaxLanes(Tag());

constexpr std::size_t batch = 16;                       // particles
constexpr std::size_t room = SpreadKernel::most_width;  // in front of the first cell
constexpr std::size_t stride = room + SpreadKernel::most_width;

// The kernel at the cells of `batch` coordinates. Values are stored by halves and loaded much
// later: loads that straddle stores under way would wait for them.
struct Values {
    HWY_ALIGN double at[batch][stride] = {};
    std::size_t first[batch];  // cell

    const double* of(std::size_t j) const { return at[j] + room; }
};

// `groups` of four cells hold half of the width. The kernel is even: with p(t) = E(t²) + t O(t²)
// the polynomial of a cell, that of its mirror image is E(t²) − t O(t²).
template <std::size_t groups>
HWY_INLINE void evaluate(const SpreadKernel& kernel, const double* HWY_RESTRICT x,
                         std::size_t count, Values& values) {
    constexpr std::size_t vectors = groups * SpreadKernel::padding / lanes;
    constexpr Tag tag;
    const auto width = static_cast<std::size_t>(kernel.width());
    const double shift = static_cast<double>(SpreadTile::halo) - 0.5 * kernel.width();
    for (std::size_t j = 0; j < count; ++j) {
        // The first cell that the kernel reaches, and where the particle stands from it.
        const double left = std::ceil(x[j] + shift);
        values.first[j] = static_cast<std::size_t>(left);
        const auto t = hn::Set(tag, 2 * (left - (x[j] + shift)) - 1);
        const auto square = hn::Mul(t, t);
        const double* next = kernel.coefficients();
        Vector even[vectors];
        Vector odd[vectors];
        for (std::size_t v = 0; v < vectors; ++v) {
            even[v] = hn::LoadU(tag, next + v * lanes);
            odd[v] = hn::LoadU(tag, next + (vectors + v) * lanes);
        }
        for (int power = 1; power < kernel.powers(); ++power) {
            next += 2 * vectors * lanes;
            for (std::size_t v = 0; v < vectors; ++v) {
                even[v] = hn::MulAdd(even[v], square, hn::LoadU(tag, next + v * lanes));
                odd[v] = hn::MulAdd(odd[v], square, hn::LoadU(tag, next + (vectors + v) * lanes));
            }
        }
        double* cells = values.at[j] + room;
        for (std::size_t v = 0; v < vectors; ++v) {
            const auto mirrored = hn::Reverse(tag, hn::NegMulAdd(odd[v], t, even[v]));
            hn::StoreU(mirrored, tag, cells + width - (v + 1) * lanes);
        }
        for (std::size_t v = 0; v < vectors; ++v) {
            hn::StoreU(hn::MulAdd(odd[v], t, even[v]), tag, cells + v * lanes);
        }
    }
}

// `groups` of four cells hold the width.
template <std::size_t groups>
HWY_INLINE void add_batch(const Values& x, const Values& y, std::size_t width, std::size_t count,
                          const double* weights, double* HWY_RESTRICT tile) {
    constexpr std::size_t vectors = groups * SpreadKernel::padding / lanes;
    constexpr Tag tag;
    for (std::size_t j = 0; j < count; ++j) {
        const double weight = weights == nullptr ? 1.0 : weights[j];
        Vector kx[vectors];
        for (std::size_t v = 0; v < vectors; ++v) {
            kx[v] = hn::Mul(hn::LoadU(tag, x.of(j) + v * lanes), hn::Set(tag, weight));
        }
        double* row = tile + y.first[j] * SpreadTile::columns + x.first[j];
        const double* of_rows = y.of(j);
        for (std::size_t m = 0; m < width; ++m, row += SpreadTile::columns) {
            const auto of_row = hn::Set(tag, of_rows[m]);
            for (std::size_t v = 0; v < vectors; ++v) {
                double* at = row + v * lanes;
                hn::StoreU(hn::MulAdd(of_row, kx[v], hn::LoadU(tag, at)), tag, at);
            }
        }
    }
}

template <std::size_t groups>
HWY_INLINE void spread_groups(const SpreadKernel& kernel, std::span<const double> x,
                              std::span<const double> y,
                              std::span<const std::span<const double>> weights,
                              std::span<SpreadTile> tiles) {
    constexpr std::size_t halves = (groups + 1) / 2;
    const auto width = static_cast<std::size_t>(kernel.width());
    Values of_x;
    Values of_y;
    for (std::size_t from = 0; from < x.size(); from += batch) {
        const std::size_t count = std::min(batch, x.size() - from);
        evaluate<halves>(kernel, x.data() + from, count, of_x);
        evaluate<halves>(kernel, y.data() + from, count, of_y);
        for (std::size_t c = 0; c < tiles.size(); ++c) {
            const double* weight = weights.empty() ? nullptr : weights[c].data() + from;
            add_batch<groups>(of_x, of_y, width, count, weight, tiles[c].value.data());
        }
    }
}

void spread_all(const SpreadKernel& kernel, std::span<const double> x, std::span<const double> y,
                std::span<const std::span<const double>> weights, std::span<SpreadTile> tiles) {
    switch (kernel.padded_width() / SpreadKernel::padding) {
        case 1:
            return spread_groups<1>(kernel, x, y, weights, tiles);
        case 2:
            return spread_groups<2>(kernel, x, y, weights, tiles);
        case 3:
            return spread_groups<3>(kernel, x, y, weights, tiles);
        default:
            return spread_groups<4>(kernel, x, y, weights, tiles);
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
    powers_ = (width_ + 5) / 2;
    beta_ = 2.3 * width_;
    const std::size_t half = (padded_ / padding + 1) / 2 * padding;
    coefficients_.assign(2 * static_cast<std::size_t>(powers_) * half, 0.0);
    for (std::size_t m = 0; m < half && m < static_cast<std::size_t>(width_); ++m) {
        // Highest power first, which is odd: odd and even ones take turns.
        const auto c = polynomial(2 * powers_ - 1, [&](double t) {
            return value(0.5 * (t + 1) - 0.5 * width_ + static_cast<double>(m));
        });
        for (std::size_t p = 0; p < c.size(); ++p) {
            const std::size_t row = p % 2 == 0 ? p + 1 : p - 1;  // even ones in front
            coefficients_[row * half + m] = c[p];
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
            std::span<const std::span<const double>> weights, std::span<SpreadTile> tiles) {
    HWY_DYNAMIC_DISPATCH(spread_all)(kernel, x, y, weights, tiles);
}

}  // namespace grainfield::analysis

#endif  // HWY_ONCE
