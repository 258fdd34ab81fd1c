#include "tests/support/slit_spheres.h"

#include <algorithm>
#include <cmath>
#include <complex>

#include <gtest/gtest.h>

namespace grainfield::testing {
namespace {

void expect_inside(const SlitScene& scene) {
    for (std::size_t i = 0; i < scene.position.size(); ++i) {
        ASSERT_GE(scene.z[i], 0);
        ASSERT_LE(scene.z[i], scene.height - 1);
        ASSERT_GE(std::min(scene.position[i].x, scene.position[i].y), 0.5);
        ASSERT_LE(std::max(scene.position[i].x, scene.position[i].y), scene.side - 0.5);
    }
}

TEST(SlitSpheres, NeverOverlapAndStayBetweenThePlates) {
    for (const double spacing : {0.72, 0.81, 0.9243}) {
        const auto scene = shaken_bilayer(30, 1.94, spacing, 0.1, 50, 1);
        EXPECT_GE(closest_approach(scene), 1) << spacing;
        expect_inside(scene);
    }
    const auto patch = patch_in_liquid(40, 1.84, 10, 0.75, 1, 0.1, 50, 2);
    EXPECT_GE(closest_approach(patch), 1);
    expect_inside(patch);
}

TEST(SlitSpheres, AreManyAtTheFillingOfTheExperiment) {
    // N = 4 φ L²/(π a²) for L = 100 a, φ = .919, less the strip along the walls.
    const auto scene = shaken_bilayer(100.5, 1.94, 0.9243, 0.15, 0, 1);
    EXPECT_EQ(scene.position.size(), 108U * 108U);
}

TEST(SlitSpheres, MeltAtTheFillingOfTheExperiment) {
    // |Σ exp(ik·r)|/N at the lattice's reciprocal vector: 1 for the crystal, ~1/sqrt(N) for a
    // liquid.
    const auto order = [](int sweeps) {
        const double k = 2 * 3.14159265358979 / 0.9243;
        const auto scene = shaken_bilayer(40, 1.94, 0.9243, 0.15, sweeps, 3);
        std::complex<double> sum;
        for (const Vec2 p : scene.position) sum += std::polar(1.0, k * p.x);
        return std::abs(sum) / static_cast<double>(scene.position.size());
    };
    EXPECT_NEAR(order(0), 1, 1e-9);
    EXPECT_LT(order(1000), 0.15);
}

}  // namespace
}  // namespace grainfield::testing
