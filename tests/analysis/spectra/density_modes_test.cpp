#include "analysis/spectra/density_modes.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

TEST(ModeGrid, CoversTheHalfPlaneOnceUpToKMax) {
    const ModeGrid grid({0.1, 0.13}, 2);
    std::size_t wanted = 0;
    for (int nx = -25; nx <= 25; ++nx) {
        for (int ny = -25; ny <= 25; ++ny) {
            if (nx == 0 && ny == 0) continue;
            if (std::hypot(0.1 * nx, 0.13 * ny) <= 2 * (1 + 1e-12)) ++wanted;
        }
    }
    EXPECT_EQ(2 * grid.modes().size(), wanted);
    for (std::size_t m = 0; m < grid.modes().size(); ++m) {
        EXPECT_EQ(grid.index(grid.modes()[m].nx, grid.modes()[m].ny), m);
        EXPECT_LE(grid.modes()[m].k, 2 * (1 + 1e-12));
    }
}

TEST(ModeGrid, RefusesAnImpossibleNumberOfModes) {
    EXPECT_THROW(ModeGrid({1e-6, 1e-6}, 2), OptionError);
}

TEST(DensityModes, EqualTheSumOfExponentialsTo1e12) {
    RandomStream random(1, "modes");
    for (const std::size_t n : {1U, 2U, 255U, 256U, 257U, 1000U}) {
        const Box box{{-4, 9}, {30, 20}, {Boundary::walls, Boundary::walls}, 0};
        const std::vector<Vec2> points = poisson_points(n, box, random);
        const ModeGrid grid({std::numbers::pi / 30, std::numbers::pi / 20}, 7);
        const auto rho = density_modes(points, box.origin, grid);
        double worst = 0;
        for (std::size_t m = 0; m < rho.size(); ++m) {
            std::complex<long double> sum;
            for (Vec2 p : points) {
                const long double phase =
                    static_cast<long double>(grid.modes()[m].nx) * grid.spacing().x *
                        (static_cast<long double>(p.x) - box.origin.x) +
                    static_cast<long double>(grid.modes()[m].ny) * grid.spacing().y *
                        (static_cast<long double>(p.y) - box.origin.y);
                sum += std::complex<long double>(std::cos(phase), -std::sin(phase));
            }
            const std::complex<double> truth(static_cast<double>(sum.real()),
                                             static_cast<double>(sum.imag()));
            worst = std::max(worst, std::abs(rho[m] - truth));
        }
        EXPECT_LT(worst, 1e-12 * std::sqrt(static_cast<double>(n))) << n;
    }
}

// Both patterns have exactly the same differences from their corners.
TEST(DensityModes, AreTheSameBitsABillionDiametersAway) {
    RandomStream random(2, "far modes");
    const Vec2 far{1e9, -1e9};
    std::vector<Vec2> points;
    std::vector<Vec2> moved;
    for (int i = 0; i < 500; ++i) {
        moved.push_back(far + Vec2{random.uniform(0, 20), random.uniform(0, 20)});
        points.push_back(moved.back() - far);
    }
    const ModeGrid grid({2 * std::numbers::pi / 20, 2 * std::numbers::pi / 20}, 4);
    EXPECT_EQ(density_modes(moved, far, grid), density_modes(points, {}, grid));
    // Phases of raw coordinates are off by some 1e-7.
    const auto raw = density_modes(moved, {}, grid);
    EXPECT_GT(std::abs(std::norm(raw.back()) - std::norm(density_modes(points, {}, grid).back())),
              1e-9);
}

TEST(WeightedModes, EqualTheWeightedSumOfExponentials) {
    RandomStream random(2, "modes");
    const Box box{{-4, 9}, {30, 20}, {Boundary::periodic, Boundary::periodic}, 0};
    const std::vector<Vec2> points = poisson_points(300, box, random);
    std::vector<double> weights;
    for (std::size_t j = 0; j < points.size(); ++j) weights.push_back(random.normal());
    const ModeGrid grid({2 * std::numbers::pi / 30, 2 * std::numbers::pi / 20}, 3);
    const auto modes = weighted_modes(points, weights, box.origin, grid);
    for (std::size_t m = 0; m < modes.size(); ++m) {
        std::complex<double> sum = 0;
        for (std::size_t j = 0; j < points.size(); ++j) {
            const Vec2 r = points[j] - box.origin;
            const double phase = grid.modes()[m].nx * grid.spacing().x * r.x +
                                 grid.modes()[m].ny * grid.spacing().y * r.y;
            sum += weights[j] * std::polar(1.0, -phase);
        }
        EXPECT_LT(std::abs(modes[m] - sum), 1e-11) << m;
    }
}

TEST(DensityModes, OfAPerfectLatticeVanishOffBraggToTheSquareRootOf1e18) {
    RandomStream random(2, "bragg");
    const std::vector<Vec2> points = square_lattice(100, 1, 0, random);
    const double dk = 2 * std::numbers::pi / 100;
    const ModeGrid grid({dk, dk}, 2);
    for (const auto& rho : density_modes(points, {0, 0}, grid)) {
        EXPECT_LT(std::norm(rho) / 1e4, 1e-18);
    }
}

TEST(DensityModes, OfNoParticlesAreZero) {
    for (const auto& rho : density_modes({}, {0, 0}, ModeGrid({1, 1}, 3))) {
        EXPECT_EQ(rho, std::complex<double>(0, 0));
    }
}

TEST(ModeGrid, RefusesTooManyModesBeforeItTakesMemoryForThem) {
    EXPECT_THROW(ModeGrid({1e-9, 1e-9}, 2), OptionError);
    EXPECT_THROW(ModeGrid({1e-9, 10}, 2), OptionError);  // many in one direction only
    EXPECT_THROW(ModeGrid({1e-300, 1}, 2), OptionError);
    EXPECT_GE(ModeGrid::about({0.1, 0.07}, 2),
              0.97 * static_cast<double>(ModeGrid({0.1, 0.07}, 2).modes().size()));
}

}  // namespace
}  // namespace grainfield::analysis
