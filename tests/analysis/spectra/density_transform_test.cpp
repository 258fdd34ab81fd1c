#include "analysis/spectra/density_transform.h"

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;
using Modes = std::vector<std::complex<double>>;

double worst_difference(const Modes& a, const Modes& b) {
    double worst = 0;
    for (std::size_t m = 0; m < a.size(); ++m) worst = std::max(worst, std::abs(a[m] - b[m]));
    return worst;
}

// Root of the mean square, relative to that of the truth.
double relative_difference(const Modes& a, const Modes& truth) {
    double squares = 0;
    double norm = 0;
    for (std::size_t m = 0; m < a.size(); ++m) {
        squares += std::norm(a[m] - truth[m]);
        norm += std::norm(truth[m]);
    }
    return std::sqrt(squares / norm);
}

TEST(NonuniformFourier, HasTheErrorThatIsAskedFor) {
    RandomStream random(1, "tolerance");
    const Box box{{-4, 9}, {30, 20}, {Boundary::walls, Boundary::walls}, 0};
    const std::vector<Vec2> points = poisson_points(2000, box, random);
    for (const double steps : {1.0, 2.0}) {  // π/L: half of the torus is empty; 2π/L
        const ModeGrid grid({steps * std::numbers::pi / 30, steps * std::numbers::pi / 20}, 5);
        const Modes truth = density_modes(points, box.origin, grid);
        for (int digits = 3; digits <= 14; ++digits) {
            const double tolerance = std::pow(10, -digits);
            const NonuniformFourier fourier(grid, tolerance);
            const Modes rho = fourier.modes(points, {}, box.origin, grid);
            // The direct sum itself is right to some 1e-14.
            EXPECT_LT(relative_difference(rho, truth), std::max(tolerance, 2e-14)) << digits;
        }
    }
}

TEST(NonuniformFourier, IsRightTo1e12ForEveryModeOfAVideoFrame) {
    RandomStream random(2, "frame");
    const Box box = square_box(100, Boundary::walls);
    const std::vector<Vec2> points = poisson_points(11704, box, random);
    const ModeGrid grid({std::numbers::pi / 100, std::numbers::pi / 100}, 2);
    const NonuniformFourier fourier(grid);
    const Modes truth = density_modes(points, {0, 0}, grid);
    const Modes rho = fourier.modes(points, {}, {0, 0}, grid);
    EXPECT_LT(relative_difference(rho, truth), 1e-12);
    EXPECT_LT(worst_difference(rho, truth) / std::sqrt(11704.0), 3e-12);
}

TEST(NonuniformFourier, TakesKindsOfWeights) {
    RandomStream random(3, "weights");
    const Box box = square_box(25);
    const std::vector<Vec2> points = poisson_points(700, box, random);
    std::vector<double> weights, others;
    for (std::size_t j = 0; j < points.size(); ++j) {
        weights.push_back(random.normal());
        others.push_back(random.uniform());
    }
    const ModeGrid grid({2 * std::numbers::pi / 25, 2 * std::numbers::pi / 25}, 6);
    const NonuniformFourier fourier(grid);
    const std::array<std::span<const double>, 2> both{weights, others};
    const Modes rho = fourier.modes(points, both, {0, 0}, grid);
    ASSERT_EQ(rho.size(), 2 * grid.modes().size());
    const auto half = rho.begin() + static_cast<std::ptrdiff_t>(grid.modes().size());
    EXPECT_LT(relative_difference(Modes(rho.begin(), half),
                                  weighted_modes(points, weights, {0, 0}, grid)),
              1e-12);
    EXPECT_LT(
        relative_difference(Modes(half, rho.end()), weighted_modes(points, others, {0, 0}, grid)),
        1e-12);
    EXPECT_EQ(fourier.modes(points, std::span(both).first(1), {0, 0}, grid),
              Modes(rho.begin(), half));
}

TEST(NonuniformFourier, OfAPerfectLatticeVanishesOffBraggTo1e18) {
    RandomStream random(4, "bragg");
    const std::vector<Vec2> points = square_lattice(100, 1, 0, random);
    const ModeGrid grid({2 * std::numbers::pi / 100, 2 * std::numbers::pi / 100}, 2);
    const NonuniformFourier fourier(grid);
    for (const auto& rho : fourier.modes(points, {}, {0, 0}, grid)) {
        EXPECT_LT(std::norm(rho) / 1e4, 1e-18);
    }
}

TEST(NonuniformFourier, KnowsPositionsOutsideTheTorusAndFarFromZero) {
    RandomStream random(5, "far");
    const Vec2 far{1e6, -3e6};
    const Box box{far, {12, 12}, {Boundary::periodic, Boundary::periodic}, 0};
    std::vector<Vec2> points = poisson_points(300, box, random);
    for (std::size_t j = 0; j < points.size(); ++j) {
        if (j % 3 == 0) points[j] += Vec2{12, -24};  // whole periods away
        if (j % 5 == 0) points[j] = far;             // many at one place, on the corner
    }
    const ModeGrid grid({2 * std::numbers::pi / 12, 2 * std::numbers::pi / 12}, 4);
    const NonuniformFourier fourier(grid);
    EXPECT_LT(
        relative_difference(fourier.modes(points, {}, far, grid), density_modes(points, far, grid)),
        1e-12);
}

TEST(NonuniformFourier, WorksOnGridsOfOneModeAndOfNoParticles) {
    for (const double k_max : {1.0, 1.5, 3.0}) {
        const ModeGrid grid({1, 1}, k_max);
        const NonuniformFourier fourier(grid);
        RandomStream random(6, "small");
        const Box box = square_box(2 * std::numbers::pi);
        const std::vector<Vec2> points = poisson_points(50, box, random);
        EXPECT_LT(worst_difference(fourier.modes(points, {}, {0, 0}, grid),
                                   density_modes(points, {0, 0}, grid)),
                  1e-11);
        for (const auto& rho : fourier.modes({}, {}, {0, 0}, grid)) EXPECT_EQ(std::abs(rho), 0);
    }
    const ModeGrid flat({0.1, 100}, 5);  // one axis only
    const std::vector<Vec2> points{{0.3, 0}, {17, 0}, {60, 0}};
    EXPECT_LT(worst_difference(NonuniformFourier(flat).modes(points, {}, {0, 0}, flat),
                               density_modes(points, {0, 0}, flat)),
              1e-11);
}

TEST(DensityTransform, TakesFewModesDirectlyAndManyByFourier) {
    const double dk = 2 * std::numbers::pi / 100;
    const DensityTransform few(ModeGrid({dk, dk}, 4 * dk));
    EXPECT_TRUE(few.is_direct(11704));
    const DensityTransform many(ModeGrid({dk / 2, dk / 2}, 2));
    EXPECT_FALSE(many.is_direct(11704));
    EXPECT_TRUE(many.is_direct(5));  // the transform would cost more than the sum
    EXPECT_FALSE(NonuniformFourier::is_affordable(ModeGrid({1e-3, 1e-3}, 1.2)));
}

}  // namespace
}  // namespace grainfield::analysis
