#include "tracking/detect/residual_blocks.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

struct Scene {
    PaddedImage darkness, transmission;
};

Scene noisy(int width, int height, double noise) {
    Image d(width, height);
    Image t(width, height);
    RandomStream random(1, "residual");
    for (std::size_t i = 0; i < d.size(); ++i) {
        t.pixels()[i] = static_cast<float>(random.uniform(0, 1));
        d.pixels()[i] = 1 - t.pixels()[i] + static_cast<float>(noise * random.normal());
    }
    return {PaddedImage(d, 20, 1.0F), PaddedImage(t, 20, 0.0F)};
}

bool holds(const std::vector<PixelBlock>& places, int x, int y) {
    for (const PixelBlock& p : places) {
        if (x >= p.x0 && x < p.x1 && y >= p.y0 && y < p.y1) return true;
    }
    return false;
}

TEST(ResidualBlocks, TheTotalIsTheSumOfSquaredResiduals) {
    const Scene scene = noisy(67, 41, 0.1);
    double sum = 0;
    for (int y = 0; y < 41; ++y) {
        for (int x = 0; x < 67; ++x) {
            sum += std::pow(
                static_cast<double>(scene.darkness(x, y) - 1 + scene.transmission(x, y)), 2);
        }
    }
    EXPECT_NEAR(ResidualBlocks(scene.darkness, scene.transmission, 9).total(), sum, 1e-4 * sum);
}

TEST(ResidualBlocks, EveryPixelWithEnoughMisfitWithinOneBlockIsHeld) {
    Scene scene = noisy(67, 41, 0.02);
    for (int x = 30; x < 34; ++x) scene.darkness.row(20)[x] += 0.7F;
    scene.darkness.row(0)[66] += 0.9F;
    const int block = 9;
    const double least = 0.5;
    const auto places = ResidualBlocks(scene.darkness, scene.transmission, block).holding(least);
    int held = 0;
    for (int y = 0; y < 41; ++y) {
        for (int x = 0; x < 67; ++x) {
            held += holds(places, x, y);
            double near = 0;
            for (int v = std::max(0, y - block); v <= std::min(40, y + block); ++v) {
                for (int u = std::max(0, x - block); u <= std::min(66, x + block); ++u) {
                    if (std::hypot(u - x, v - y) > block) continue;
                    near += std::pow(
                        static_cast<double>(scene.darkness(u, v) - 1 + scene.transmission(u, v)),
                        2);
                }
            }
            if (near < least) continue;
            EXPECT_TRUE(holds(places, x, y)) << x << " " << y;
        }
    }
    EXPECT_GT(held, 0);
    EXPECT_LT(held, 67 * 41 / 2);
}

TEST(ResidualBlocks, NothingIsHeldWhereThereIsOnlyNoise) {
    const Scene scene = noisy(67, 41, 0.02);
    EXPECT_TRUE(ResidualBlocks(scene.darkness, scene.transmission, 9).holding(0.5).empty());
}

TEST(ResidualBlocks, WhatIsKnownToGoIsTakenFromItsOwnBlock) {
    Scene scene = noisy(67, 41, 0.01);
    for (int y = 18; y < 27; ++y) {
        for (int x = 36; x < 45; ++x) scene.darkness.row(y)[x] += 0.5F;
    }
    ResidualBlocks blocks(scene.darkness, scene.transmission, 9);
    const double total = blocks.total();
    EXPECT_NEAR(blocks.rms(67 * 41), std::sqrt(total / (67 * 41)), 1e-12);
    const std::vector<PixelBlock> before = blocks.holding(10);
    ASSERT_EQ(before.size(), 3U);
    const std::vector<Vec2> middles = blocks.middles(before);
    EXPECT_EQ(middles.size(), 9U);
    EXPECT_EQ(middles[4], (Vec2{40, 22}));
    blocks.subtract({40, 22}, 19);
    EXPECT_DOUBLE_EQ(blocks.total(), total - 19);
    EXPECT_TRUE(blocks.holding(10).empty());
}

TEST(PixelBlock, AreasOfBlocksAreAdded) {
    EXPECT_EQ(area_of({}), 0);
    EXPECT_EQ(area_of({{0, 0, 9, 9}, {9, 0, 67, 4}}), 81 + 58 * 4);
}

TEST(ResidualBlocks, UsualIsWhatMostDiscsHaveAround) {
    Scene scene = noisy(200, 150, 0.1);
    for (int y = 90; y < 110; ++y) {
        for (int x = 30; x < 60; ++x) scene.darkness.row(y)[x] += 0.5F;
    }
    std::vector<Vec2> discs;
    for (int y = 15; y < 136; y += 10) {
        for (int x = 15; x < 186; x += 10) {
            discs.push_back({static_cast<double>(x), static_cast<double>(y)});
        }
    }
    const ResidualBlocks blocks(scene.darkness, scene.transmission, 10);
    const auto usual = blocks.usual(discs);
    // 900 pixels of variance 0.01, whose sum scatters by sqrt(2/900) of it.
    EXPECT_NEAR(usual.median, 9, 0.5);
    EXPECT_NEAR(usual.spread, 9 * std::sqrt(2.0 / 900), 0.13);
    EXPECT_EQ(blocks.usual({}).median, 0);
}

}  // namespace
}  // namespace grainfield::tracking
