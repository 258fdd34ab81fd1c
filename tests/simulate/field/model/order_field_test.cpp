#include "simulate/field/model/order_field.h"

#include <cmath>
#include <complex>
#include <numbers>

#include <gtest/gtest.h>

namespace grainfield::simulate {
namespace {

constexpr double everything = 1e9;

ModelOptions soft() {
    ModelOptions model;
    model.nu = 0.3;
    return model;
}

template <class Real>
std::vector<double> field_of(const OrderField<Real>& order, const Lattice& lattice) {
    typename OrderField<Real>::Scratch scratch(lattice);
    AlignedVector<Real> rows(lattice.stride() * OrderField<Real>::rows_at_once);
    std::vector<double> values;
    for (int first = 0; first < lattice.ny; first += OrderField<Real>::rows_at_once) {
        order.read_rows(first, scratch, rows.data());
        for (int y = first; y < std::min(lattice.ny, first + OrderField<Real>::rows_at_once); ++y) {
            for (int x = 0; x < lattice.nx; ++x) {
                values.push_back(static_cast<double>(
                    rows[static_cast<std::size_t>(y - first) * lattice.stride() +
                         static_cast<std::size_t>(x)]));
            }
        }
    }
    return values;
}

// c_k of a real field by the definition.
std::complex<double> mode_of(const std::vector<double>& psi, const Lattice& lattice, int kx,
                             int ky) {
    std::complex<double> sum = 0;
    for (int y = 0; y < lattice.ny; ++y) {
        for (int x = 0; x < lattice.nx; ++x) {
            const double turns =
                static_cast<double>(kx) * x / lattice.nx + static_cast<double>(ky) * y / lattice.ny;
            sum += psi[static_cast<std::size_t>(y * lattice.nx + x)] *
                   std::polar(1.0, -2 * std::numbers::pi * turns);
        }
    }
    return sum / static_cast<double>(lattice.cells());
}

template <class Real>
void advance(OrderField<Real>& order, std::uint64_t step) {
    on_team(1, [&](Team& team) { order.advance(step, team); });
}

// Every mode that modes() lists is found again in the field, and the field has no other.
template <class Real>
void expect_field_of_modes(const Lattice& lattice, double k_cut) {
    OrderField<Real> order(lattice, OrderSpectrum(lattice, soft(), 0.5, OrderScheme::exact, k_cut),
                           5);
    order.draw_stationary();
    advance(order, 1);
    const std::vector<double> psi = field_of(order, lattice);
    const std::vector<double> modes = order.modes();
    const OrderSpectrum& spectrum = order.spectrum();
    std::size_t next = 0;
    double power = 0;
    const double tolerance = 200 * static_cast<double>(std::numeric_limits<Real>::epsilon());
    for (int kx = 0; kx < spectrum.columns(); ++kx) {
        const int rows = spectrum.rows(kx);
        const int negative = std::min(rows, lattice.ny - 1 - rows);
        for (int i = 0; i <= rows + negative; ++i, next += 2) {
            const int ky = i <= rows ? i : i - rows - negative - 1;
            const std::complex<double> c(modes[next], modes[next + 1]);
            EXPECT_LT(std::abs(mode_of(psi, lattice, kx, ky) - c), tolerance)
                << lattice.nx << " x " << lattice.ny << " mode " << kx << ", " << ky;
            power += std::norm(c) * (kx == 0 || 2 * kx == lattice.nx ? 1 : 2);
        }
    }
    ASSERT_EQ(next, modes.size());
    double square = 0;
    for (double value : psi) square += value * value / static_cast<double>(psi.size());
    EXPECT_NEAR(square, power, tolerance * (1 + power));
}

TEST(OrderField, IsTheInverseTransformOfItsModes) {
    for (const auto& [nx, ny] :
         {std::pair{8, 8}, {9, 7}, {16, 5}, {7, 20}, {1, 6}, {2, 2}, {4, 4}}) {
        for (const double k_cut : {everything, 2.0}) {
            expect_field_of_modes<double>({2, nx, ny, 0.65}, k_cut);
            expect_field_of_modes<float>({2, nx, ny, 0.65}, k_cut);
        }
    }
    for (const int nx : {1, 2, 13, 32}) expect_field_of_modes<double>({1, nx, 1, 0.25}, everything);
}

// Mean square of each mode over N independent stationary draws: relative error sqrt(1/N) for
// complex modes (2 degrees), sqrt(2/N) for real ones. All modes of a lattice within 5.5 sigma:
// false alarms 35 · 4e-8 ≈ 1e-6.
void expect_stationary_modes(const Lattice& lattice) {
    const ModelOptions model = soft();
    for (const OrderScheme scheme : {OrderScheme::exact, OrderScheme::crank_nicolson}) {
        for (const double dt : {0.05, 3.0}) {
            const OrderSpectrum spectrum(lattice, model, dt, scheme, everything);
            std::vector<double> squares;
            const int draws = 4000;
            for (int i = 0; i < draws; ++i) {
                OrderField<double> order(lattice, spectrum, static_cast<std::uint64_t>(i));
                order.draw_stationary();
                advance(order, 1);
                const std::vector<double> modes = order.modes();
                squares.resize(modes.size() / 2, 0);
                for (std::size_t m = 0; m < squares.size(); ++m) {
                    squares[m] +=
                        (modes[2 * m] * modes[2 * m] + modes[2 * m + 1] * modes[2 * m + 1]) / draws;
                }
            }
            std::size_t next = 0;
            for (int kx = 0; kx < spectrum.columns(); ++kx) {
                const int rows = spectrum.rows(kx);
                const int negative = std::min(rows, lattice.ny - 1 - rows);
                for (int i = 0; i <= rows + negative; ++i, ++next) {
                    const int ky = i <= rows ? i : rows + negative + 1 - i;
                    const double sigma2 = spectrum.stationary(kx)[ky] * spectrum.stationary(kx)[ky];
                    EXPECT_NEAR(squares[next] / sigma2, 1, 5.5 * std::sqrt(2.0 / draws))
                        << "mode " << kx << ", " << ky << " dt " << dt;
                }
            }
        }
    }
}

TEST(OrderField, StationaryModesHaveTheVarianceOfTheModelAndKeepIt) {
    expect_stationary_modes({2, 6, 7, 0.65});
    expect_stationary_modes({1, 38, 1, 0.25});
}

TEST(OrderSpectrum, ClosedFormOfTheVariance) {
    // 2D, b = 4: C2/(16 sqrt(mu nu)); the lattice sum converges to it (discreteness: the box is
    // many correlation lengths wide; cut at pi/dx: − C2/(8 pi mu k²) of it, below 1.2 %).
    ModelOptions model;
    model.nu = 0.01;
    model.mu = 2;
    model.c2 = 3;
    const double plane = order_variance({2, 256, 256, 0.65}, model);
    EXPECT_NEAR(plane / (3 / (16 * std::sqrt(0.02))), 1, 0.012);
    model.b = 2;
    // 1D, b = 2: C2/(4 sqrt(mu nu)), cut − C2/(2 pi mu k_max).
    const double line = order_variance({1, 4096, 1, 0.25}, model);
    EXPECT_NEAR(line + 3 / (2 * std::numbers::pi * 2 * (std::numbers::pi / 0.25)),
                3 / (4 * std::sqrt(0.02)), 2e-3);
}

TEST(OrderSpectrum, WhatTheCutLeavesOutIsKnown) {
    const Lattice lattice{2, 64, 64, 0.65};
    const ModelOptions model = soft();
    const OrderSpectrum all(lattice, model, 0.5, OrderScheme::exact, everything);
    EXPECT_EQ(all.kept(), all.all());
    EXPECT_EQ(all.missing_variance(), 0);
    const OrderSpectrum cut(lattice, model, 0.5, OrderScheme::exact, 2);
    double kept = 0;
    for (int kx = 0; kx < cut.columns(); ++kx) {
        for (int ky = 0; ky <= cut.rows(kx); ++ky) {
            const double sigma = cut.stationary(kx)[ky];
            kept += sigma * sigma * (kx == 0 ? 1 : 2) * (ky == 0 ? 1 : 2);
        }
    }
    EXPECT_NEAR(kept + cut.missing_variance(), order_variance(lattice, model), 1e-12);
    EXPECT_LT(cut.kept(), all.all() / 4);
}

TEST(OrderSpectrum, AModeWithoutRateDiffuses) {
    ModelOptions model;
    model.nu = 0;
    const Lattice lattice{2, 8, 8, 1};
    const OrderSpectrum spectrum(lattice, model, 0.5, OrderScheme::exact, everything);
    EXPECT_TRUE(spectrum.diffuses());
    EXPECT_EQ(spectrum.loss(0)[0], 0);
    EXPECT_NEAR(spectrum.amplitude(0)[0], std::sqrt(0.5 / 64), 1e-15);
    EXPECT_EQ(spectrum.stationary(0)[0], 0);
}

// ν dt = 8.4e-8 is 1.4 steps of a float below one: kept as the factor 1 − ν dt it would be 40 % too
// small. 64 modes of one rate (μ = 0) begin 10 standard deviations out and lose 18 % of that; the
// noise on their mean is 0.5 % of it, 2.6 % of the loss.
TEST(OrderField, SlowModesRelaxAtTheirRateInSinglePrecision) {
    const Lattice lattice{2, 8, 8, 1};
    ModelOptions model;
    model.mu = 0;
    model.nu = 8.4e-8;
    OrderField<float> order(lattice,
                            OrderSpectrum(lattice, model, 1, OrderScheme::exact, everything), 3);
    const double deviation = std::sqrt(model.c2 / (2 * model.nu * 64));
    std::vector<double> modes = order.modes();
    for (std::size_t i = 0; i < modes.size(); i += 2) modes[i] = 10 * deviation;
    order.set_modes(modes);
    constexpr int steps = 2400000;
    on_team(1, [&](Team& team) {
        for (int step = 1; step <= steps; ++step) {
            order.advance(static_cast<std::uint64_t>(step), team);
        }
    });
    modes = order.modes();
    double mean = 0;
    for (std::size_t i = 0; i < modes.size(); i += 2) {
        mean += modes[i] / deviation / (0.5 * static_cast<double>(modes.size()));
    }
    const double loss = -std::expm1(-model.nu * steps);
    EXPECT_NEAR((1 - mean / 10) / loss, 1, 0.15);
}

void expect_same_noise(const Lattice& lattice, const std::vector<std::pair<int, int>>& modes) {
    const auto first_modes = [&](double k_cut) {
        OrderField<double> order(lattice,
                                 OrderSpectrum(lattice, soft(), 0.5, OrderScheme::exact, k_cut), 1);
        order.draw_stationary();
        advance(order, 1);
        const std::vector<double> psi = field_of(order, lattice);
        std::vector<std::complex<double>> found;
        for (const auto& [kx, ky] : modes) found.push_back(mode_of(psi, lattice, kx, ky));
        return found;
    };
    const auto all = first_modes(everything);
    const auto cut = first_modes(1.5);
    for (std::size_t m = 0; m < all.size(); ++m) EXPECT_LT(std::abs(all[m] - cut[m]), 1e-14);
}

TEST(OrderField, AModeHasTheSameNoiseWhateverElseIsKept) {
    expect_same_noise({2, 32, 32, 0.65}, {{1, 0}, {2, 3}, {2, -3}});
    expect_same_noise({1, 64, 1, 0.25}, {{0, 0}, {1, 0}, {3, 0}});
}

// Parts would be equal if numbers of the generator were used twice. |r| of 2,000 steps has σ =
// .022; 6 σ leave 7,750 pairs a chance of 2e-5.
TEST(OrderField, PartsOfTheModesOfALineAreIndependent) {
    const Lattice lattice{1, 130, 1, 0.25};
    OrderField<double> order(lattice, OrderSpectrum(lattice, soft(), 50, OrderScheme::exact, 12),
                             9);
    order.draw_stationary();
    constexpr int steps = 2000;
    std::vector<std::vector<double>> parts;
    for (int step = 1; step <= steps; ++step) {
        advance(order, static_cast<std::uint64_t>(step));
        parts.push_back(order.modes());
    }
    const std::size_t count = parts.front().size();
    ASSERT_EQ(count, 126U);
    const auto product = [&](std::size_t a, std::size_t b) {
        double sum = 0;
        for (const std::vector<double>& modes : parts) sum += modes[a] * modes[b];
        return sum;
    };
    for (std::size_t a = 0; a < count; ++a) {
        for (std::size_t b = a + 1; b < count; ++b) {
            if (a == 1 || b == 1) continue;  // the imaginary part of k = 0 is zero
            const double r = product(a, b) / std::sqrt(product(a, a) * product(b, b));
            EXPECT_LT(std::abs(r), 6 / std::sqrt(double{steps})) << a << ", " << b;
        }
    }
}

}  // namespace
}  // namespace grainfield::simulate
