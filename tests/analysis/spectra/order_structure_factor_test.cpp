#include "analysis/spectra/order_structure_factor.h"

#include <cmath>
#include <complex>
#include <limits>
#include <map>
#include <numbers>
#include <string>

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;
using Order = std::vector<std::complex<double>>;

std::complex<double> sum_over(const Pattern& pattern, const Order& order, double kx, double ky) {
    std::complex<double> sum = 0;
    for (std::size_t j = 0; j < order.size(); ++j) {
        const double phase = kx * pattern.position[j].x + ky * pattern.position[j].y;
        sum += order[j] * std::polar(1.0, -phase);
    }
    return sum;
}

const std::vector<double>& values(const ObservableResult& result, const char* curve,
                                  const char* column) {
    return result.find_curve(curve)->find(column)->values;
}

// The plain sums at k and −k, shell by shell.
TEST(OrderStructureFactor, IsTheSumOverAllParticles) {
    RandomStream random(1, "order");
    const Box box = square_box(20, Boundary::periodic, {3, -7});
    const Pattern p = pattern(poisson_points(300, box, random), box);
    Order order;
    for (std::size_t j = 0; j < p.size(); ++j) order.push_back({random.normal(), random.normal()});
    OrderStructureFactor s4({.modes = {.k_max = 1}}, box, 1);
    s4.add(s4.measure(p, order));
    const ObservableResult result = s4.result();
    const double dk = 2 * std::numbers::pi / 20;
    std::map<long, std::pair<double, int>> shells;  // by k² in steps of dk²
    for (int nx = -3; nx <= 3; ++nx) {
        for (int ny = -3; ny <= 3; ++ny) {
            const int n2 = nx * nx + ny * ny;
            if (n2 == 0 || n2 > 10) continue;
            auto& [sum, count] = shells[n2];
            sum += std::norm(sum_over(p, order, nx * dk, ny * dk)) / 300;
            ++count;
        }
    }
    const auto& k = values(result, "s4", "k");
    ASSERT_EQ(k.size(), shells.size());
    std::size_t i = 0;
    for (const auto& [n2, shell] : shells) {
        EXPECT_NEAR(k[i], dk * std::sqrt(static_cast<double>(n2)), 1e-12);
        EXPECT_NEAR(values(result, "s4", "s")[i] / (shell.first / shell.second), 1, 1e-11);
        ++i;
    }
}

// Independent order, independent frames: S4 = ⟨|Q|²⟩ at every k. Walls: the connected estimator.
TEST(OrderStructureFactor, OfIndependentOrderIsItsVariance) {
    for (const Boundary boundary : {Boundary::periodic, Boundary::walls}) {
        RandomStream random(2, "order");
        const Box box = square_box(30, boundary);
        OrderStructureFactor s4({.modes = {.k_max = 0.8}}, box, 64);
        for (int frame = 0; frame < 64; ++frame) {
            const Pattern p = pattern(poisson_points(400, box, random), box, frame);
            Order order;
            for (std::size_t j = 0; j < p.size(); ++j) {
                order.push_back({0.3 * random.normal(), 0.4 * random.normal()});
            }
            s4.add(s4.measure(p, order));
        }
        const ObservableResult result = s4.result();
        const auto& s = values(result, "s4", "s");
        const auto& error = values(result, "s4", "s_err");
        for (std::size_t i = 0; i < s.size(); ++i) {
            EXPECT_NEAR(s[i], 0.25, 5.5 * error[i]) << i;
            EXPECT_LT(error[i], 0.25 * 0.25);
        }
    }
}

// A field of order with S4(0) = 50 and ξ4 = 4 a on a lattice, mode by mode.
TEST(OrderStructureFactor, FindsTheCorrelationLengthOfAnOrnsteinZernikeField) {
    RandomStream random(3, "order");
    constexpr int side = 40;
    constexpr int frames = 48;
    const Box box = square_box(side);
    std::vector<Vec2> lattice = square_lattice(side, 1, 0, random);
    const double dk = 2 * std::numbers::pi / side;
    constexpr int most = 8;
    OrderStructureFactor s4({.modes = {.k_max = 1.2}, .fit_k_max = 1.2}, box, frames);
    for (int frame = 0; frame < frames; ++frame) {
        const Pattern p = pattern(lattice, box, frame);
        Order order(p.size());
        for (int nx = -most; nx <= most; ++nx) {
            for (int ny = -most; ny <= most; ++ny) {
                const double k2 = dk * dk * (nx * nx + ny * ny);
                const double size = std::sqrt(50 / (1 + 16 * k2) / (2.0 * side * side));
                const std::complex<double> c{size * random.normal(), size * random.normal()};
                for (std::size_t j = 0; j < p.size(); ++j) {
                    const Vec2 r = p.position[j];
                    order[j] += c * std::polar(1.0, dk * (nx * r.x + ny * r.y));
                }
            }
        }
        s4.add(s4.measure(p, order));
    }
    const ObservableResult result = s4.result();
    const Measurement* zero = result.find_measurement("s4_zero");
    const Measurement* xi = result.find_measurement("xi4");
    EXPECT_NEAR(zero->value.value(), 50, 5 * zero->error.value());
    EXPECT_NEAR(xi->value.value(), 4, 5 * xi->error.value());
    EXPECT_LT(xi->error.value(), 0.4);
    EXPECT_LT(zero->error.value(), 10);
    EXPECT_NE(result.find_curve("s4_fit"), nullptr);
}

// One orientation everywhere: the mean order is no fluctuation. Particles without a Q count not.
TEST(OrderStructureFactor, IgnoresParticlesWithoutOrderAndStaticOrder) {
    RandomStream random(4, "order");
    const Box box = square_box(20, Boundary::walls);
    const Pattern p = pattern(poisson_points(200, box, random), box);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    OrderStructureFactor all({.modes = {.k_max = 1}}, box, 4),
        some({.modes = {.k_max = 1}}, box, 4);
    for (int frame = 0; frame < 4; ++frame) {
        Order order(p.size(), 1);
        all.add(all.measure(p, order));
        Pattern part = p;
        Order of_part = order;
        part.position.push_back({1, 1});
        of_part.push_back({nan, nan});
        some.add(some.measure(part, of_part));
    }
    const ObservableResult result = all.result();
    for (const double s : values(result, "s4", "s")) EXPECT_LT(std::abs(s), 1e-9);
    EXPECT_EQ(values(result, "s4", "s"), values(some.result(), "s4", "s"));
    EXPECT_FALSE(result.find_measurement("xi4")->value.has_value());
    EXPECT_FALSE(result.find_measurement("xi4")->reason.empty());
}

// Orders of random phase that grow to twice and a half their amplitude.
TEST(OrderStructureFactor, HasNoFitWhereTheOrderGrowsWhileTheRunLasts) {
    const Box box = square_box(40);
    for (const double growth : {0.0, 0.025}) {
        RandomStream random(9, "growing order");
        OrderStructureFactor s4({.modes = {.k_max = 1}}, box, 60);
        for (int f = 0; f < 60; ++f) {
            const Pattern p = pattern(poisson_points(400, box, random), box, f);
            Order order;
            for (std::size_t j = 0; j < p.size(); ++j) {
                order.push_back(
                    std::polar(0.3 * (1 + growth * f), 2 * std::numbers::pi * random.uniform()));
            }
            s4.add(s4.measure(p, order));
        }
        const ObservableResult result = s4.result();
        const Measurement* found = result.find_measurement("s4_growth");
        ASSERT_NE(found, nullptr);
        const bool is_steady =
            result.find_measurement("xi4")->reason.find("not steady") == std::string::npos;
        EXPECT_EQ(is_steady, growth == 0) << result.find_measurement("xi4")->reason;
        EXPECT_EQ(*found->value > 2, growth > 0);
    }
}

}  // namespace
}  // namespace grainfield::analysis
