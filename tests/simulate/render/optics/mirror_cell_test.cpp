#include "simulate/render/optics/mirror_cell.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace grainfield::simulate {
namespace {

/// How far across a ray lands that leaves height `from` at `angle`: through air above and below a
/// plate of refractive index 1.52.
double landing(double from, double angle, const RaytraceOptions& o) {
    const double within = std::asin(std::sin(angle) / 1.52);
    return (from + o.panel_distance - o.glass_thickness) * std::tan(angle) +
           o.glass_thickness * std::tan(within);
}

// The edge of the panel is where the closed form says: a ray that starts a little nearer sees it, a
// little farther out it does not.
TEST(MirrorCell, ARayThroughThePlateLandsWhereSnellSays) {
    const EmbreeDevice device;
    SphereScene empty;
    empty.high_plate = 1.94;
    for (const double glass : {0.0, 4.0, 10.0, 20.0}) {
        RaytraceOptions options;
        options.glass_thickness = glass;
        options.panel_distance = 20;
        options.panel_half_size = 50;
        const MirrorCell cell(device, {&empty, 1}, {3, -2}, options);
        for (const double degrees : {0.0, 20.0, 45.0, 60.0}) {
            const double angle = degrees * std::numbers::pi / 180;
            const double height = 1.3;
            const double edge = options.panel_half_size - landing(height, angle, options);
            const Vec3 down{std::sin(angle), 0, -std::cos(angle)};
            EXPECT_GT(cell.panel({3 + edge - 1e-6, -2, height}, down), 0) << glass << degrees;
            EXPECT_EQ(cell.panel({3 + edge + 1e-6, -2, height}, down), 0) << glass << degrees;
        }
    }
}

TEST(MirrorCell, SpheresBelowThePlateDoNotMoveThePanel) {
    const EmbreeDevice device;
    SphereScene scene;
    scene.high_plate = 1.94;
    SphereScene lower = scene;
    lower.centre = {{-30, 0, 0.42}};  // the plate swings down by 0.08
    RaytraceOptions options;
    const MirrorCell one(device, {&scene, 1}, {0, 0}, options);
    const MirrorCell two(device, {&lower, 1}, {0, 0}, options);
    const Vec3 down{std::sin(1.2), 0, -std::cos(1.2)};
    const double edge = options.panel_half_size - landing(1, 1.2, options);
    for (const double x : {edge - 1e-6, edge + 1e-6}) {
        EXPECT_EQ(one.panel({x, 0, 1}, down), two.panel({x, 0, 1}, down));
    }
}

}  // namespace
}  // namespace grainfield::simulate
