// Number variance of point processes with closed forms. The variance of n independent windows has
// the relative standard error sqrt((2 + κ)/n), κ the excess kurtosis; windows side by side in T
// frames give n ≥ T (L/ℓ)², overlapping ones more precision. 6 standard errors: p < 1e-7 a test.

#include <cmath>

#include <gtest/gtest.h>

#include "analysis/density/number_variance.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

TEST(NumberVarianceTheory, OfAFixedNumberOfIndependentPointsIsBinomial) {
    const double length = 20;
    const int frames = 4000;
    const std::size_t particles = 400;
    const Box box = square_box(length);
    NumberVariance variance({.step = 1}, box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(1, "binomial", static_cast<std::uint64_t>(f));
        variance.add(variance.measure(pattern(poisson_points(particles, box, random), box, f)));
    }
    const ObservableResult r = variance.result();
    const Curve* curve = r.find_curve("variance");
    const auto& l = curve->find("l")->values;
    for (std::size_t s = 0; s + 1 < l.size(); ++s) {
        const double share = l[s] * l[s] / (length * length);
        const double wanted = 400 * share * (1 - share);
        const double windows = frames * std::floor(length / l[s]) * std::floor(length / l[s]);
        const double kurtosis = 1 / wanted;  // of a binomial, at most
        EXPECT_NEAR(curve->find("variance")->values[s], wanted,
                    6 * wanted * std::sqrt((2 + kurtosis) / windows))
            << "l = " << l[s];
        EXPECT_NEAR(curve->find("mean")->values[s], 400 * share, 1e-9);
    }
    EXPECT_EQ(curve->find("variance")->values.back(), 0);
}

TEST(NumberVarianceTheory, OfAUniformlyRandomisedLatticeGrowsWithThePerimeter) {
    // σ²(m a) = 2m/3 − 1/9, for lattices at random places.
    const int side = 24;
    const int frames = 4000;
    const Box box = square_box(side);
    NumberVariance variance({.largest = 10, .step = 0.5}, box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(2, "randomised lattice", static_cast<std::uint64_t>(f));
        const Vec2 shift{random.uniform(), random.uniform()};
        std::vector<Vec2> points;
        for (int iy = 0; iy < side; ++iy) {
            for (int ix = 0; ix < side; ++ix) {
                points.push_back(shift + Vec2{ix + random.uniform(), iy + random.uniform()});
            }
        }
        variance.add(variance.measure(pattern(std::move(points), box, f)));
    }
    const ObservableResult r = variance.result();
    for (std::size_t s = 0; s < 10; ++s) {
        const double m = static_cast<double>(s) + 1;
        const double wanted = 2 * m / 3 - 1.0 / 9;
        const double independent = std::pow(std::floor(side / m), 2);
        // All windows of a frame share the offset of the lattice: u² + (1 − u)² with mean 2/3 and
        // standard deviation 0.149 per axis, 0.447 of the variance at most.
        const double error = std::sqrt((0.447 * 0.447 * 2 + 2.5 / independent) / frames);
        EXPECT_NEAR(r.find_curve("variance")->find("variance")->values[s], wanted,
                    6 * wanted * error)
            << "m = " << m;
    }
}

TEST(NumberVarianceTheory, HasErrorsThatCoverTheScatterOfRepeatedRuns) {
    // 100 runs of 64 frames: the mean square of (value − truth)/error must be near 1 (Student's t
    // with 15 degrees of freedom: 15/13 = 1.15, its standard error about 0.2 over 100 runs).
    const Box box = square_box(10, Boundary::walls);
    double squares = 0;
    for (std::uint64_t run = 0; run < 100; ++run) {
        NumberVariance variance({.largest = 4, .step = 1, .border = 0.0}, box, 64);
        for (int f = 0; f < 64; ++f) {
            RandomStream random(run + 10, "coverage", static_cast<std::uint64_t>(f));
            variance.add(variance.measure(pattern(poisson_points(200, box, random), box, f)));
        }
        const Curve curve = *variance.result().find_curve("variance");
        const double truth = 200 * 0.04 * 0.96;
        const double pull =
            (curve.find("variance")->values[1] - truth) / curve.find("err")->values[1];
        squares += pull * pull / 100;
    }
    EXPECT_GT(squares, 0.4);
    EXPECT_LT(squares, 2.4);
}

}  // namespace
}  // namespace grainfield::analysis
