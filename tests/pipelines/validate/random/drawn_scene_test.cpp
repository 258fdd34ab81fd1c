#include "pipelines/validate/random/drawn_scene.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "simulate/md/state/initial_state.h"
#include "simulate/render/optics/raytrace.h"

namespace grainfield::pipelines {
namespace {

TEST(DrawnScene, DependsOnSeedAndNumberAlone) {
    const DrawnScene seventh = draw_scene(5, 7, SceneSize::full);
    static_cast<void>(draw_scene(5, 8, SceneSize::full));
    EXPECT_EQ(draw_scene(5, 7, SceneSize::full), seventh);
    EXPECT_NE(draw_scene(5, 8, SceneSize::full), seventh);
    EXPECT_NE(draw_scene(6, 7, SceneSize::full), seventh);
    // The size changes nothing but the number of spheres.
    DrawnScene small = draw_scene(5, 7, SceneSize::small);
    EXPECT_LT(small.spheres, 501);
    small.spheres = seventh.spheres;
    EXPECT_EQ(small, seventh);
}

// 2,000 draws: none falls outside, the outermost hundredth at either end is hit (chance of missing
// one: 2e-9), and the median is that of the law (5 standard errors of a median: 0.056 of the
// quantile).
TEST(DrawnScene, FillsItsRanges) {
    struct Law {
        const char* name;
        double low, high;
        bool is_logarithmic;
        std::function<double(const DrawnScene&)> of;
    };
    const std::vector<Law> laws{
        {"panel", 2, 30, true, [](const auto& d) { return d.panel_distance; }},
        {"reflectivity", 0.5, 0.9, false, [](const auto& d) { return d.reflectivity; }},
        {"blur", 0.04, 0.12, false, [](const auto& d) { return d.blur; }},
        {"aperture", 0, 0.04, false, [](const auto& d) { return d.aperture; }},
        {"vignetting", 0, 0.3, false, [](const auto& d) { return d.vignetting; }},
        {"level", 1, 1.1, false, [](const auto& d) { return d.level; }},
        {"noise", 0.005, 0.05, true, [](const auto& d) { return d.noise; }},
        {"stray", 0, 0.05, false, [](const auto& d) { return d.stray; }},
        {"scale", 8, 24, true, [](const auto& d) { return d.scale; }},
        {"density", 0.9, 1.2, false, [](const auto& d) { return d.density; }},
        {"spheres", 1000, 3000, true, [](const auto& d) { return double(d.spheres); }},
        {"amplitude", 0.08, 0.2, false, [](const auto& d) { return d.amplitude; }},
        {"phase", 0, 1, false, [](const auto& d) { return d.phase; }}};
    constexpr int n = 2000;
    for (const Law& law : laws) {
        std::vector<double> parts;
        for (int i = 0; i < n; ++i) {
            const double value = law.of(draw_scene(1, i, SceneSize::full));
            parts.push_back(law.is_logarithmic
                                ? std::log(value / law.low) / std::log(law.high / law.low)
                                : (value - law.low) / (law.high - law.low));
        }
        std::sort(parts.begin(), parts.end());
        EXPECT_GE(parts.front(), -1e-12) << law.name;
        EXPECT_LE(parts.back(), 1 + 1e-12) << law.name;
        EXPECT_LT(parts.front(), 0.01) << law.name;
        EXPECT_GT(parts.back(), 0.99) << law.name;
        EXPECT_NEAR(parts[n / 2], 0.5, 0.056) << law.name;
    }
}

TEST(DrawnScene, HasACrystalInTheShareAskedForAndIsOtherwiseTheSame) {
    constexpr int n = 2000;
    int crystals = 0;
    for (int i = 0; i < n; ++i) {
        const DrawnScene liquid = draw_scene(3, i, SceneSize::full);
        EXPECT_FALSE(liquid.crystal.has_value());
        DrawnScene drawn = draw_scene(3, i, SceneSize::full, 0.25);
        if (drawn.crystal) {
            ++crystals;
            EXPECT_GE(drawn.crystal->share, 0.1);
            EXPECT_LE(drawn.crystal->share, 0.5);
            EXPECT_GE(drawn.crystal->spacing, 0.76);
            EXPECT_LE(drawn.crystal->spacing, 0.86);
            EXPECT_GE(drawn.crystal->periods, 1);
            EXPECT_LE(drawn.crystal->periods, 10);
            drawn.crystal.reset();
            drawn.density = liquid.density;
        }
        EXPECT_EQ(drawn, liquid);
    }
    EXPECT_NEAR(crystals, 0.25 * n, 5 * std::sqrt(0.25 * 0.75 * n));
}

// The start places whole rows, so that a small crystal is smaller than its share.
TEST(DrawnScene, WithACrystalFitsIntoItsCellAndHasTheLiquidThatIsDrawn) {
    for (int i = 0; i < 200; ++i) {
        const SceneSize size = i % 2 == 0 ? SceneSize::small : SceneSize::full;
        const DrawnScene drawn = draw_scene(4, i, size, 1);
        const simulate::MdOptions md = layer_of(drawn);
        EXPECT_EQ(md.initial.layout, simulate::InitialLayout::square);
        EXPECT_NO_THROW(simulate::make_initial_state(md, 1)) << i;
        const double side = md.cell.length_x;
        const double patch = std::sqrt(drawn.crystal->share) * (side - 2);
        const double in_patch = std::pow(patch / drawn.crystal->spacing, 2);
        const double beyond = side * side - std::pow(patch + 2, 2);
        const double liquid = (static_cast<double>(drawn.spheres) - in_patch) / beyond;
        EXPECT_GE(liquid, 0.5 - 1e-9) << i;
        EXPECT_LE(liquid, 0.65 + 1e-9) << i;
    }
}

// 5 standard errors of a share of 2/3 and of 1/2.
TEST(DrawnScene, HasAPinholeTwiceOfThreeTimesAndWallsInSightOnceOfTwo) {
    constexpr int n = 2000;
    int pinholes = 0;
    int walls = 0;
    for (int i = 0; i < n; ++i) {
        const DrawnScene drawn = draw_scene(2, i, SceneSize::full);
        if (drawn.distance) {
            ++pinholes;
            EXPECT_GE(*drawn.distance, 30);
            EXPECT_LE(*drawn.distance, 300.0001);
        }
        walls += drawn.walls_seen ? 1 : 0;
    }
    EXPECT_NEAR(pinholes / double{n}, 2.0 / 3, 5 * std::sqrt(2.0 / 9 / n));
    EXPECT_NEAR(walls / double{n}, 0.5, 5 * std::sqrt(0.25 / n));
}

TEST(DrawnScene, IsTheLayerAndTheCameraThatItSays) {
    DrawnScene drawn = draw_scene(3, 4, SceneSize::full);
    drawn.distance = 50;
    const simulate::MdOptions md = layer_of(drawn);
    EXPECT_NEAR(static_cast<double>(md.cell.grains) / (md.cell.length_x * md.cell.length_y),
                drawn.density, 1e-12);
    EXPECT_EQ(md.cell.height, 1.94);
    for (const bool seen : {true, false}) {
        drawn.walls_seen = seen;
        const simulate::RenderOptions camera = camera_of(drawn);
        const double side = camera.view.width / drawn.scale;
        EXPECT_NEAR(side - md.cell.length_x, seen ? 4 : -4, 0.5 / drawn.scale);
        EXPECT_NEAR(camera.view.distance / side, 50, 0.1);
        EXPECT_EQ(camera.view.projection, simulate::Projection::perspective);
        // Photon noise as drawn; read noise a tenth of it.
        EXPECT_NEAR(simulate::bright_field_noise(camera), 1.01 * drawn.noise * drawn.noise, 1e-12);
        EXPECT_EQ(camera.optics.of<simulate::Raytrace>().reflectivity, drawn.reflectivity);
        EXPECT_EQ(camera.optics.of<simulate::Raytrace>().panel_distance, drawn.panel_distance);
        EXPECT_EQ(camera.light.blur, drawn.blur);
        simulate::require_valid(camera);
    }
    drawn.distance.reset();
    EXPECT_EQ(camera_of(drawn).view.projection, simulate::Projection::telecentric);
}

}  // namespace
}  // namespace grainfield::pipelines
