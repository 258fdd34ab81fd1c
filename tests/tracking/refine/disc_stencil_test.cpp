#include "tracking/refine/disc_stencil.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/tracking/refine/disc_oracle.h"
#include "tracking/refine/computed_disc.h"
#include "tracking/refine/disc_kernel.h"
#include "tracking/refine/drawn_disc.h"

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
        : stencil(disc, image.pitch()),
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
        const DiscStencil stencil(disc, 500);
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

/// Σ J (I − M) of disc j over the edge, or over all pixels; in double precision.
Vec2 oracle_gradient(Scene& scene, std::size_t j, const std::vector<DiscStencil::Piece>& pieces) {
    const Anchor anchor = Anchor::of(scene.centre[j]);
    Vec2 sum;
    for (const DiscStencil::Piece& piece : pieces) {
        for (int i = 0; i < DiscStencil::kLanes; ++i) {
            const int x = anchor.x + static_cast<int>(piece.dx) + i;
            const int y = anchor.y + static_cast<int>(piece.dy);
            if (x < 0 || y < 0 || x >= scene.darkness.width() || y >= scene.darkness.height()) {
                continue;
            }
            double t = 1;
            for (const Vec2 c : scene.centre)
                t *= oracle_transmission(std::hypot(x - c.x, y - c.y));
            const Vec2 d = Vec2{static_cast<double>(x), static_cast<double>(y)} - scene.centre[j];
            const double p = 1 - oracle_transmission(norm(d));
            const double residual = static_cast<double>(scene.darkness(x, y)) - 1 + t;
            sum += (residual * t * 2 / kDisc.edge_width * p / std::max(norm(d), 1e-9)) * d;
        }
    }
    return sum;
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
        // χ² = Σ r², dχ²/dx = −2 b.
        const Vec2 whole = oracle_gradient(scene, j, scene.stencil.pieces());
        EXPECT_NEAR(-2 * whole.x, derivative({1, 0}), 1e-3) << j;
        EXPECT_NEAR(-2 * whole.y, derivative({0, 1}), 1e-3) << j;
        // b sums 60 edge pixels of half-float error 2e-4.
        const Vec2 edge = oracle_gradient(scene, j, scene.stencil.edge_pieces());
        EXPECT_NEAR(n.bx, edge.x, 0.01) << j;
        EXPECT_NEAR(n.by, edge.y, 0.01) << j;
    }
}

TEST(DiscStencil, TheEdgeHoldsAllButTwoThousandthsOfTheInformation) {
    for (const DiscProfile disc :
         {DiscProfile{3, 0.4}, kDisc, DiscProfile{16, 1.2}, DiscProfile{200, 3}}) {
        const DiscStencil stencil(disc, 500);
        for (const Vec2 c : {Vec2{0.75, 0.75}, Vec2{-0.75, 0.3}, Vec2{0, 0}}) {
            const auto information = [&](const std::vector<DiscStencil::Piece>& pieces) {
                double sum = 0;
                for (const DiscStencil::Piece& piece : pieces) {
                    const Vec2 first{static_cast<double>(piece.dx), static_cast<double>(piece.dy)};
                    for (int i = 0; i < DiscStencil::kLanes; ++i) {
                        const double slope = disc.slope(norm(first + Vec2{1.0 * i, 0} - c));
                        sum += slope * slope;
                    }
                }
                return sum;
            };
            EXPECT_GT(information(stencil.edge_pieces()), 0.998 * information(stencil.pieces()))
                << disc.diameter;
        }
        // Each is part of a full row.
        for (const DiscStencil::Piece& edge : stencil.edge_pieces()) {
            const int first = static_cast<int>(edge.dx);
            const auto row =
                std::find_if(stencil.rows().begin(), stencil.rows().end(),
                             [&](const auto& r) { return r.dy == static_cast<int>(edge.dy); });
            ASSERT_NE(row, stencil.rows().end());
            EXPECT_GE(first, row->first);
            EXPECT_LE(first + DiscStencil::kLanes, row->first + row->count);
            EXPECT_EQ(edge.at - row->at, first - row->first);
            EXPECT_EQ(edge.offset, row->dy * 500 + first);
        }
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
    const double change = shift(scene.view(1), moved[1], Redraw::whole, before);
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
    redraw(scene.view(1), moved[1], Redraw::whole);
    EXPECT_EQ(scene.transmission.inner(), shifted);
}

TEST(DiscStencil, ASmallShiftOfTheEdgeAloneIsNearlyThatOfTheWholeAndIsUndone) {
    Scene scene(kCentres, kDisc, noisy_darkness());
    const Image start = scene.transmission.inner();
    const std::vector<HalfFloat> kept = scene.kept[1];
    std::vector<Vec2> moved = kCentres;
    moved[1] += Vec2{0.04, -0.04};
    BeforeShift before;
    const double change = shift(scene.view(1), moved[1], Redraw::edge, before);
    EXPECT_NEAR(change,
                oracle_misfit(scene.darkness, moved) - oracle_misfit(scene.darkness, kCentres),
                2e-2);
    const Image expected = Scene(moved, kDisc, scene.darkness).transmission.inner();
    const Image shifted = scene.transmission.inner();
    for (std::size_t i = 0; i < shifted.size(); ++i) {
        EXPECT_NEAR(shifted.pixels()[i], expected.pixels()[i], 1e-3);
    }
    undo(scene.view(1), before);
    EXPECT_EQ(scene.transmission.inner(), start);
    EXPECT_EQ(scene.kept[1], kept);
    // What is not redrawn divides out all the same.
    shift(scene.view(1), moved[1], Redraw::edge, before);
    lift(scene.view(1));
    const std::vector<Vec2> others{kCentres[0], kCentres[2], kCentres[3]};
    const Image without = Scene(others, kDisc, scene.darkness).transmission.inner();
    const Image lifted = scene.transmission.inner();
    for (std::size_t i = 0; i < lifted.size(); ++i) {
        EXPECT_NEAR(lifted.pixels()[i], without.pixels()[i], 2e-6);
    }
}

// What JointFit draws at the same time lies one such width apart.
TEST(DiscStencil, NoRowEndsBeyondTheWidth) {
    for (double diameter = 2; diameter < 40; diameter += 0.5) {
        for (const int spacing : {1, 2}) {
            const DiscStencil stencil({diameter, 1.2}, 1000, spacing);
            int first = 0;
            int last = 0;
            for (const DiscStencil::Row& row : stencil.rows()) {
                first = std::min(first, row.first);
                last = std::max(last, row.first + row.count - 1);
            }
            EXPECT_EQ(stencil.width(), last - first + 1) << diameter;
        }
    }
}

TEST(DiscStencil, CouplingIsTheSumOfProductsOfGradients) {
    // Beside, above and across one another.
    for (const Vec2 step : {Vec2{9.3, 0.4}, Vec2{-1.2, 8.8}, Vec2{6.1, -7.2}, Vec2{5.2, 3.1}}) {
        const std::vector<Vec2> centres{{15.6, 15.2}, Vec2{15.6, 15.2} + step};
        Scene scene(centres, kDisc, noisy_darkness());
        const CrossBlock block = coupling(scene.view(0), centres[0], scene.view(1), centres[1]);
        double xx = 0;
        double xy = 0;
        double yx = 0;
        double yy = 0;
        for (int y = 0; y < 33; ++y) {
            for (int x = 0; x < 33; ++x) {
                double t = 1;
                for (const Vec2 c : centres) t *= oracle_transmission(std::hypot(x - c.x, y - c.y));
                const auto j = [&](Vec2 c) {
                    const double r = std::hypot(x - c.x, y - c.y);
                    const double g =
                        t * 2 / kDisc.edge_width * (1 - oracle_transmission(r)) / std::max(r, 1e-9);
                    return Vec2{g * (x - c.x), g * (y - c.y)};
                };
                xx += j(centres[0]).x * j(centres[1]).x;
                xy += j(centres[0]).x * j(centres[1]).y;
                yx += j(centres[0]).y * j(centres[1]).x;
                yy += j(centres[0]).y * j(centres[1]).y;
            }
        }
        // The information of one disc alone is about 4 here.
        EXPECT_NEAR(block.xx, xx, 3e-3);
        EXPECT_NEAR(block.xy, xy, 3e-3);
        EXPECT_NEAR(block.yx, yx, 3e-3);
        EXPECT_NEAR(block.yy, yy, 3e-3);
        const CrossBlock turned = coupling(scene.view(1), centres[1], scene.view(0), centres[0]);
        EXPECT_NEAR(turned.xy, block.yx, 1e-4);
    }
}

TEST(DiscStencil, TheMarginNeverChanges) {
    const std::vector<Vec2> corners{{-0.5, 3}, {32.5, 32.5}, {16, -0.5}, {-0.5, 32.5}};
    Scene scene(corners, kDisc, noisy_darkness());
    BeforeShift before;
    for (std::size_t j = 0; j < corners.size(); ++j)
        shift(scene.view(j), corners[j], Redraw::whole, before);
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
