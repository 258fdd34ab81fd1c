#include "tracking/refine/disc_kernel.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/tracking/refine/disc_oracle.h"

namespace grainfield::tracking {
namespace {

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
}

}  // namespace
}  // namespace grainfield::tracking
