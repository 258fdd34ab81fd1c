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

double oracle_misfit(const PaddedImage& darkness, const std::vector<Vec2>& centres) {
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

PaddedImage model(const std::vector<Vec2>& centres) {
    PaddedImage t = clear_transmission(33, 33, kDisc);
    for (const Vec2 c : centres) place_disc(t, c, kDisc);
    return t;
}

PaddedImage noisy_darkness() {
    RandomStream random(3, "darkness");
    Image d = model(kCentres).inner();
    for (float& v : d.pixels()) v = 1 - v + static_cast<float>(0.05 * random.normal());
    return padded_darkness(d, kDisc);
}

NormalEquations normal_equations(const PaddedImage& darkness, const PaddedImage& transmission,
                                 Vec2 centre, const DiscProfile& disc) {
    DiscWindow window;
    window.enclose(darkness, centre, disc.reach());
    return linearise(darkness, transmission, centre, disc, window);
}

TEST(DiscKernel, PlacingEqualsTheReferenceProfile) {
    const PaddedImage t = model({kCentres[0]});
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
    PaddedImage t = model(kCentres);
    const Image before = t.inner();
    place_disc(t, {14, 17}, kDisc);
    lift_disc(t, {14, 17}, kDisc);
    const Image after = t.inner();
    for (std::size_t i = 0; i < after.size(); ++i) {
        EXPECT_NEAR(after.pixels()[i], before.pixels()[i], 1e-6);
    }
}

TEST(DiscKernel, TheGradientIsTheDerivativeOfTheMisfit) {
    const PaddedImage darkness = noisy_darkness();
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
    PaddedImage t = clear_transmission(81, 81, disc);
    place_disc(t, {40.3, 39.8}, disc);
    const PaddedImage darkness = padded_darkness(Image(81, 81), disc);
    const NormalEquations n = normal_equations(darkness, t, {40.3, 39.8}, disc);
    const double expected = 3.14159265 * 40 / (6 * 1.5);
    EXPECT_NEAR(n.xx, expected, 0.01 * expected);
    EXPECT_NEAR(n.yy, expected, 0.01 * expected);
    EXPECT_NEAR(n.xy, 0, 0.01 * expected);
}

TEST(DiscKernel, ShiftingReportsTheChangeOfTheMisfitAndEqualsRebuilding) {
    const PaddedImage darkness = noisy_darkness();
    PaddedImage t = model(kCentres);
    const Image start = t.inner();
    std::vector<Vec2> moved = kCentres;
    moved[1] += Vec2{0.7, -0.5};
    DiscWindow window;
    window.enclose(darkness, kCentres[1], kDisc.reach() + 0.9);
    linearise(darkness, t, kCentres[1], kDisc, window);
    const double change = shift_disc(darkness, t, moved[1], kDisc, window);
    EXPECT_NEAR(change, oracle_misfit(darkness, moved) - oracle_misfit(darkness, kCentres), 2e-3);
    const Image shifted = t.inner();
    const Image rebuilt = model(moved).inner();
    for (std::size_t i = 0; i < shifted.size(); ++i) {
        EXPECT_NEAR(shifted.pixels()[i], rebuilt.pixels()[i], 2e-6);
    }
    undo_shift(t, window);
    EXPECT_EQ(t.inner(), start);
}

TEST(DiscKernel, TheMarginNeverChanges) {
    PaddedImage t = clear_transmission(33, 33, kDisc);
    for (const Vec2 c : {Vec2{-0.4, 3}, Vec2{32.4, 32.4}, Vec2{16, -0.5}}) place_disc(t, c, kDisc);
    for (int y = -t.margin(); y < 33 + t.margin(); ++y) {
        for (int x = -t.margin(); x < 33 + t.margin(); ++x) {
            const bool inside = x >= 0 && y >= 0 && x < 33 && y < 33;
            EXPECT_EQ(t(x, y) == 0.0F, !inside);
        }
    }
}

TEST(DiscKernel, LocalResidualIsTheRmsOverThePixelsOfTheImageInReach) {
    const PaddedImage darkness = noisy_darkness();
    const PaddedImage t = model(kCentres);
    for (const Vec2 c : kCentres) {
        double sum = 0;
        int n = 0;
        for (int y = 0; y < 33; ++y) {
            for (int x = 0; x < 33; ++x) {
                if (std::hypot(x - c.x, y - c.y) >= kDisc.reach()) continue;
                const double r = static_cast<double>(darkness(x, y) - 1 + t(x, y));
                sum += r * r;
                ++n;
            }
        }
        EXPECT_NEAR(local_residual(darkness, t, c, kDisc), std::sqrt(sum / n), 1e-5);
    }
}

TEST(DiscKernel, CrossBlocksAreSumsOfProductsOfGradients) {
    const PaddedImage t = model(kCentres);
    DiscWindow a;
    DiscWindow b;
    DiscGradient ga;
    DiscGradient gb;
    gradient(t, kCentres[0], kDisc, a, ga);
    gradient(t, kCentres[1], kDisc, b, gb);
    const CrossBlock block = cross_block(a, ga, b, gb);
    double xy = 0;
    double yx = 0;
    for (int y = 0; y < 33; ++y) {
        for (int x = 0; x < 33; ++x) {
            const auto j = [&](Vec2 c) {
                const double r = std::hypot(x - c.x, y - c.y);
                const double p = r < kDisc.reach() ? kDisc.darkness(r) : 0;
                const double g = static_cast<double>(t(x, y)) * 2 / kDisc.edge_width * p / r;
                return Vec2{g * (x - c.x), g * (y - c.y)};
            };
            xy += j(kCentres[0]).x * j(kCentres[1]).y;
            yx += j(kCentres[0]).y * j(kCentres[1]).x;
        }
    }
    EXPECT_NEAR(block.xy, xy, 2e-3);
    EXPECT_NEAR(block.yx, yx, 2e-3);
    const NormalEquations own = normal_equations(noisy_darkness(), t, kCentres[0], kDisc);
    const CrossBlock self = cross_block(a, ga, a, ga);
    EXPECT_NEAR(self.xx, own.xx, 1e-4 * own.xx);
    EXPECT_NEAR(self.yy, own.yy, 1e-4 * own.yy);
}

TEST(DiscKernel, ExplainedMisfitIsWhatLiftingCosts) {
    const PaddedImage darkness = noisy_darkness();
    const PaddedImage t = model(kCentres);
    const std::vector<Vec2> without{kCentres[0], kCentres[2], kCentres[3]};
    EXPECT_NEAR(explained_misfit(darkness, t, kCentres[1], kDisc),
                oracle_misfit(darkness, without) - oracle_misfit(darkness, kCentres), 2e-2);
}

TEST(DiscKernel, OutsideTheImageNothingHappens) {
    PaddedImage t = clear_transmission(20, 20, kDisc);
    const Image before = t.inner();
    place_disc(t, {-40, 10}, kDisc);
    place_disc(t, {10, 500}, kDisc);
    EXPECT_EQ(t.inner(), before);
    EXPECT_EQ(normal_equations(t, t, {-40, 10}, kDisc).xx, 0);
}

}  // namespace
}  // namespace grainfield::tracking
