#include "tracking/refine/disc_stencil.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/random.h"
#include "tests/tracking/refine/disc_oracle.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

PaddedImage noisy_darkness() {
    RandomStream random(3, "darkness");
    PaddedImage t = clear_transmission(33, 33, kDisc);
    for (const Vec2 c : kCentres) place_disc(t, c, kDisc);
    Image d = t.inner();
    for (float& v : d.pixels()) v = 1 - v + static_cast<float>(0.05 * random.normal());
    return padded_darkness(d, kDisc);
}

/// All discs of a scene, each in its window.
struct Scene {
    DiscStencil stencil;
    PaddedImage darkness;
    PaddedImage transmission;
    std::vector<Vec2> centre;
    std::vector<std::vector<HalfFloat>> kept;

    Scene(const std::vector<Vec2>& centres, const DiscProfile& disc, PaddedImage image)
        : stencil(disc),
          darkness(std::move(image)),
          transmission(clear_transmission(darkness.width(), darkness.height(), disc)),
          centre(centres) {
        for (std::size_t j = 0; j < centre.size(); ++j) {
            kept.emplace_back(stencil.size());
            place(view(j), centre[j]);
        }
    }
    StencilView view(std::size_t j) {
        return {stencil, darkness, transmission, Anchor::of(centre[j]), kept[j].data()};
    }
};

TEST(DiscStencil, PlacingEqualsTheReferenceProfileToAHalfFloat) {
    Scene scene({kCentres[0]}, kDisc, noisy_darkness());
    for (int y = 0; y < 33; ++y) {
        for (int x = 0; x < 33; ++x) {
            const double r = std::hypot(x - kCentres[0].x, y - kCentres[0].y);
            // In the core t is held at 1e-3 instead of falling to zero.
            const double tolerance = r > kDisc.radius() - 3 * kDisc.edge_width ? 8e-4 : 1.2e-3;
            EXPECT_NEAR(scene.transmission(x, y), oracle_transmission(r), tolerance);
        }
    }
}

TEST(DiscStencil, TheWindowHoldsEveryDiscThatItsAnchorHolds) {
    for (const DiscProfile disc : {DiscProfile{3, 0.4}, kDisc, DiscProfile{200, 3}}) {
        const DiscStencil stencil(disc);
        for (const Vec2 c : {Vec2{0.75, 0.75}, Vec2{-0.75, 0.3}, Vec2{0, -0.75}}) {
            const int half = static_cast<int>(disc.reach()) + 3;
            for (int y = -half; y <= half; ++y) {
                const auto row = std::find_if(stencil.rows().begin(), stencil.rows().end(),
                                              [&](const auto& r) { return r.dy == y; });
                for (int x = -half; x <= half; ++x) {
                    if (std::hypot(x - c.x, y - c.y) >= disc.reach()) continue;
                    ASSERT_NE(row, stencil.rows().end());
                    ASSERT_GE(x, row->first);
                    ASSERT_LT(x, row->first + row->count);
                }
            }
        }
    }
}

TEST(DiscStencil, LiftingUndoesPlacingAndPlacingUndoesLifting) {
    Scene with(kCentres, kDisc, noisy_darkness());
    Scene without({kCentres[0], kCentres[2], kCentres[3]}, kDisc, noisy_darkness());
    const Image before = with.transmission.inner();
    const double change = lift(with.view(1));
    EXPECT_NEAR(
        change,
        oracle_misfit(with.darkness, without.centre) - oracle_misfit(with.darkness, kCentres), 0.1);
    const Image lifted = with.transmission.inner();
    const Image expected = without.transmission.inner();
    for (std::size_t i = 0; i < lifted.size(); ++i) {
        EXPECT_NEAR(lifted.pixels()[i], expected.pixels()[i], 2e-6);
    }
    place(with.view(1), kCentres[1]);
    const Image again = with.transmission.inner();
    for (std::size_t i = 0; i < again.size(); ++i) {
        EXPECT_NEAR(again.pixels()[i], before.pixels()[i], 2e-6);
    }
    EXPECT_NEAR(explained(with.view(1)), change, 1e-3);
}

TEST(DiscStencil, TheGradientIsTheDerivativeOfTheMisfit) {
    const PaddedImage darkness = noisy_darkness();
    for (std::size_t j = 0; j < kCentres.size(); ++j) {
        std::vector<Vec2> centres = kCentres;
        centres[j] += Vec2{0.2, -0.3};
        Scene scene(centres, kDisc, darkness);
        const NormalEquations n = linearise(scene.view(j), centres[j]);
        const double h = 1e-4;
        const auto derivative = [&](Vec2 d) {
            auto plus = centres;
            auto minus = centres;
            plus[j] += h * d;
            minus[j] -= h * d;
            return (oracle_misfit(darkness, plus) - oracle_misfit(darkness, minus)) / (2 * h);
        };
        // χ² = Σ r², dχ²/dx = −2 b; b sums 60 edge pixels of half-float error 2e-4.
        EXPECT_NEAR(-2 * n.bx, derivative({1, 0}), 0.02) << j;
        EXPECT_NEAR(-2 * n.by, derivative({0, 1}), 0.02) << j;
    }
}

TEST(DiscStencil, TheNormalMatrixOfAnIsolatedDiscIsTheClosedForm) {
    // A_xx = ∫ s² cos²θ = π D/(6 w) for a disc much larger than its edge (physics: Cramér–Rao).
    const DiscProfile disc{40, 1.5};
    Scene scene({{40.3, 39.8}}, disc, padded_darkness(Image(81, 81), disc));
    const NormalEquations n = linearise(scene.view(0), {40.3, 39.8});
    const double expected = 3.14159265 * 40 / (6 * 1.5);
    EXPECT_NEAR(n.xx, expected, 0.01 * expected);
    EXPECT_NEAR(n.yy, expected, 0.01 * expected);
    EXPECT_NEAR(n.xy, 0, 0.01 * expected);
}

TEST(DiscStencil, ShiftingReportsTheChangeOfTheMisfitAndEqualsRebuilding) {
    Scene scene(kCentres, kDisc, noisy_darkness());
    const Image start = scene.transmission.inner();
    const std::vector<HalfFloat> kept = scene.kept[1];
    std::vector<Vec2> moved = kCentres;
    moved[1] += Vec2{0.7, -0.5};
    ASSERT_TRUE(scene.view(1).anchor.holds(moved[1]));
    BeforeShift before;
    const double change = shift(scene.view(1), moved[1], before);
    EXPECT_NEAR(change,
                oracle_misfit(scene.darkness, moved) - oracle_misfit(scene.darkness, kCentres),
                2e-2);
    Scene rebuilt(moved, kDisc, scene.darkness);
    const Image shifted = scene.transmission.inner();
    const Image expected = rebuilt.transmission.inner();
    for (std::size_t i = 0; i < shifted.size(); ++i) {
        EXPECT_NEAR(shifted.pixels()[i], expected.pixels()[i], 2e-6);
    }
    undo(scene.view(1), before);
    EXPECT_EQ(scene.transmission.inner(), start);
    EXPECT_EQ(scene.kept[1], kept);
}

TEST(DiscStencil, TheMarginNeverChanges) {
    const std::vector<Vec2> corners{{-0.5, 3}, {32.5, 32.5}, {16, -0.5}, {-0.5, 32.5}};
    Scene scene(corners, kDisc, noisy_darkness());
    BeforeShift before;
    for (std::size_t j = 0; j < corners.size(); ++j) shift(scene.view(j), corners[j], before);
    const PaddedImage& t = scene.transmission;
    for (int y = -t.margin(); y < 33 + t.margin(); ++y) {
        for (int x = -t.margin(); x < 33 + t.margin(); ++x) {
            const bool inside = x >= 0 && y >= 0 && x < 33 && y < 33;
            EXPECT_EQ(t(x, y) == 0.0F, !inside);
        }
    }
}

}  // namespace
}  // namespace grainfield::tracking
