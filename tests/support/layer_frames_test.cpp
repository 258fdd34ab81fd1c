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

TEST(LayerFrames, CoverageOfAnOpaqueDiscIsItsArea) {
    LayerScene scene{64, 64, 20, {{31.3, 30.8}}, {Layer::unknown}, 1};
    Camera camera;
    camera.apparent_diameter = 1;
    camera.rim_darkness = 1;
    camera.blur = 0;
    camera.vignetting = 0;
    camera.exposure = 1;
    camera.bit_depth = 16;
    camera.electrons = 1e9;
    camera.read_noise = 0;
    const Image frame = camera_frame(scene, camera, 1);
    double dark = 0;
    for (const float v : frame.pixels()) dark += (1 - static_cast<double>(v) / 65535.0) / 0.94;
    // 4 × 4 sub-pixels: the error of the edge averages out over its 250 sub-pixels.
    EXPECT_NEAR(dark / (std::numbers::pi * 100), 1.0, 3e-3);
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
