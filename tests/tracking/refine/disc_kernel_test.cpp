#include "tracking/refine/disc_kernel.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/random.h"

namespace grainfield::tracking {
namespace {

const DiscProfile kDisc{9, 1.25};
const std::vector<Vec2> kCentres{{12.3, 11.8}, {18.9, 14.2}, {1.2, 25.4}, {30.8, 30.1}};

/// The plain reference, in double precision.
double oracle_transmission(double r) {
    return r < kDisc.reach() ? 1 - kDisc.darkness(r) : 1.0;
}

double oracle_misfit(const Image& darkness, const std::vector<Vec2>& centres) {
    double sum = 0;
    for (int y = 0; y < darkness.height(); ++y) {
        for (int x = 0; x < darkness.width(); ++x) {
            double t = 1;
            for (const Vec2 c : centres) t *= oracle_transmission(std::hypot(x - c.x, y - c.y));
            const double r = static_cast<double>(darkness(x, y)) - 1 + t;
            sum += r * r;
        }
    }
    return sum;
}

Image model(const std::vector<Vec2>& centres) {
    Image t(33, 33, 1.0F);
    for (const Vec2 c : centres) place_disc(t, c, kDisc);
    return t;
}

Image noisy_darkness() {
    RandomStream random(3, "darkness");
    Image d = model(kCentres);
    for (float& v : d.pixels()) v = 1 - v + static_cast<float>(0.05 * random.normal());
    return d;
}

TEST(DiscKernel, PlacingEqualsTheReferenceProfile) {
    const Image t = model({kCentres[0]});
    for (int y = 0; y < 33; ++y) {
        for (int x = 0; x < 33; ++x) {
            const double r = std::hypot(x - kCentres[0].x, y - kCentres[0].y);
            // In the core t is held at 1e-3 instead of falling to zero.
            EXPECT_NEAR(t(x, y), oracle_transmission(r), 1e-3);
            if (r > kDisc.radius() - 3 * kDisc.edge_width) {
                EXPECT_NEAR(t(x, y), oracle_transmission(r), 2e-6);
            }
        }
    }
}

TEST(DiscKernel, LiftingUndoesPlacing) {
    Image t = model(kCentres);
    const Image before = t;
    place_disc(t, {14, 17}, kDisc);
    lift_disc(t, {14, 17}, kDisc);
    for (std::size_t i = 0; i < t.size(); ++i) {
        EXPECT_NEAR(t.pixels()[i], before.pixels()[i], 1e-6);
    }
}

TEST(DiscKernel, TheGradientIsTheDerivativeOfTheMisfit) {
    const Image darkness = noisy_darkness();
    for (std::size_t j = 0; j < kCentres.size(); ++j) {
        std::vector<Vec2> centres = kCentres;
        centres[j] += Vec2{0.2, -0.3};
        const NormalEquations n = normal_equations(darkness, model(centres), centres[j], kDisc);
        const double h = 1e-4;
        const auto derivative = [&](Vec2 d) {
            auto plus = centres;
            auto minus = centres;
            plus[j] += h * d;
            minus[j] -= h * d;
            return (oracle_misfit(darkness, plus) - oracle_misfit(darkness, minus)) / (2 * h);
        };
        // χ² = Σ r², dχ²/dx = −2 b.
        EXPECT_NEAR(-2 * n.bx, derivative({1, 0}), 0.01) << j;
        EXPECT_NEAR(-2 * n.by, derivative({0, 1}), 0.01) << j;
    }
}

TEST(DiscKernel, TheNormalMatrixOfAnIsolatedDiscIsTheClosedForm) {
    // A_xx = ∫ s² cos²θ = π D/(6 w) for a disc much larger than its edge (physics: Cramér–Rao).
    const DiscProfile disc{40, 1.5};
    Image t(81, 81, 1.0F);
    place_disc(t, {40.3, 39.8}, disc);
    const NormalEquations n = normal_equations(Image(81, 81), t, {40.3, 39.8}, disc);
    const double expected = 3.14159265 * 40 / (6 * 1.5);
    EXPECT_NEAR(n.xx, expected, 0.01 * expected);
    EXPECT_NEAR(n.yy, expected, 0.01 * expected);
    EXPECT_NEAR(n.xy, 0, 0.01 * expected);
}

TEST(DiscKernel, MovingReportsTheChangeOfTheMisfitAndEqualsRebuilding) {
    const Image darkness = noisy_darkness();
    Image t = model(kCentres);
    std::vector<Vec2> moved = kCentres;
    moved[1] += Vec2{1.1, -0.7};
    const double change = move_disc(darkness, t, kCentres[1], moved[1], kDisc);
    EXPECT_NEAR(change, oracle_misfit(darkness, moved) - oracle_misfit(darkness, kCentres), 2e-3);
    const Image rebuilt = model(moved);
    for (std::size_t i = 0; i < t.size(); ++i) {
        EXPECT_NEAR(t.pixels()[i], rebuilt.pixels()[i], 2e-6);
    }
}

TEST(DiscKernel, ExplainedMisfitIsWhatLiftingCosts) {
    const Image darkness = noisy_darkness();
    const Image t = model(kCentres);
    const std::vector<Vec2> without{kCentres[0], kCentres[2], kCentres[3]};
    EXPECT_NEAR(explained_misfit(darkness, t, kCentres[1], kDisc),
                oracle_misfit(darkness, without) - oracle_misfit(darkness, kCentres), 2e-2);
}

TEST(DiscKernel, OutsideTheImageNothingHappens) {
    Image t(20, 20, 1.0F);
    place_disc(t, {-40, 10}, kDisc);
    place_disc(t, {10, 500}, kDisc);
    for (const float v : t.pixels()) EXPECT_EQ(v, 1.0F);
    EXPECT_EQ(normal_equations(t, t, {-40, 10}, kDisc).pixels, 0);
}

}  // namespace
}  // namespace grainfield::tracking
