#include "tests/support/layer_frames.h"

#include <numbers>

#include <gtest/gtest.h>

namespace grainfield::testing {
namespace {

double smallest_distance(const LayerScene& scene, std::size_t count) {
    double smallest = 1e300;
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j < i; ++j) {
            smallest = std::min(smallest, norm(scene.position[i] - scene.position[j]));
        }
    }
    return smallest;
}

TEST(LayerFrames, HardDiscsDoNotOverlapAndHaveTheirAreaFraction) {
    const LayerScene scene = hard_disc_liquid(400, 400, 16, 0.70, 3);
    EXPECT_GE(smallest_distance(scene, scene.position.size()), 16.0);
    const double fraction = static_cast<double>(scene.position.size()) * std::numbers::pi / 4 * 16 *
                            16 / (400.0 * 400.0);
    // Whole rows and columns of the starting lattice: within one row in 25.
    EXPECT_NEAR(fraction, 0.70, 0.04);
}

TEST(LayerFrames, TheLiquidKeepsItsDistanceFromTheCrystal) {
    CrystalPatch patch;
    patch.radius = 0.25;
    const LayerScene scene = crystal_in_liquid(300, 300, 12, 0.68, patch, 5);
    ASSERT_LT(scene.crystal_begin, scene.position.size());
    for (std::size_t i = 0; i < scene.crystal_begin; ++i) {
        for (std::size_t j = scene.crystal_begin; j < scene.position.size(); ++j) {
            ASSERT_GE(norm(scene.position[i] - scene.position[j]), patch.clearance * 12 - 1e-9);
        }
    }
}

TEST(LayerFrames, CoverageOfOpaqueDiscsIsTheirArea) {
    const LayerScene scene = isolated_discs(210, 210, 20, 30, 2);
    ASSERT_EQ(scene.position.size(), 49U);
    Camera camera;
    camera.apparent_diameter = 1;
    camera.rim_darkness = 1;
    camera.blur = 0;
    camera.vignetting = 0;
    camera.bit_depth = 16;
    camera.electrons = 1e9;
    camera.read_noise = 0;
    const Image frame = camera_frame(scene, camera, 1);
    double dark = 0;
    for (const float v : frame.pixels()) {
        dark += (1 - static_cast<double>(v) / (camera.exposure * 65535)) / 0.94;
    }
    // The number of sub-pixels in a disc of radius R = 40 sub-pixels at a random place has the
    // variance 0.68 R (Kendall 1948): 1.0e-3 of the area for one disc, 1.5e-4 for 49.
    EXPECT_NEAR(dark / (49 * std::numbers::pi * 100), 1.0, 1e-3);
}

TEST(LayerFrames, TheLiquidWandersWhileTheCrystalStaysAtItsSites) {
    CrystalPatch patch;
    patch.radius = 0.25;
    const double a = 12;
    const LayerScene start = crystal_in_liquid(300, 300, a, 0.68, patch, 5);
    LayerMotion motion(start, patch, 0.06 * a, 7);
    for (int frame = 0; frame < 20; ++frame) motion.advance();
    double liquid = 0, crystal = 0;
    for (std::size_t i = 0; i < start.position.size(); ++i) {
        (i < start.crystal_begin ? liquid : crystal) +=
            squared_norm(motion.scene().position[i] - start.position[i]) / (a * a);
    }
    const auto liquid_count = static_cast<double>(start.crystal_begin);
    const auto crystal_count = static_cast<double>(start.position.size()) - liquid_count;
    // Half of the jitter moves: two axes of (0.03/2)² a². Some 240 spheres: 10 % is over two
    // standard errors of a fixed seed.
    EXPECT_NEAR(crystal / crystal_count, 2 * 0.015 * 0.015, 0.1 * 2 * 0.015 * 0.015);
    // 60 accepted steps would give 0.14 a²; neighbours refuse some of them.
    EXPECT_GT(liquid / liquid_count, 0.02);
    EXPECT_LT(liquid / liquid_count, 0.144);
    EXPECT_GE(smallest_distance(motion.scene(), start.crystal_begin), 0.88 * a);
}

TEST(LayerFrames, SameSeedGivesTheSameFrame) {
    CrystalPatch patch;
    patch.radius = 0.2;
    const LayerScene scene = crystal_in_liquid(160, 160, 10, 0.65, patch, 9);
    EXPECT_EQ(camera_frame(scene, {}, 4), camera_frame(scene, {}, 4));
    EXPECT_NE(camera_frame(scene, {}, 4), camera_frame(scene, {}, 5));
}

}  // namespace
}  // namespace grainfield::testing
