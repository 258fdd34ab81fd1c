#include "tracking/synthesis/mirror_scene.h"

#include <cmath>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

constexpr float kRadius = 0.5F;
constexpr MirrorOptics kDark{.reflectivity = 0.6, .ambient = 0, .grazing = 0};
const float kCore = kRadius / std::sqrt(2.0F);

FirstSpheres first_at(const MirrorScene& scene, float x, float y) {
    FirstSpheres row;
    scene.first_spheres({x}, y, true, row);
    return row;
}

std::int32_t first_sphere(const MirrorScene& scene, float x, float y) {
    return first_at(scene, x, y).first.front();
}

float seen(const MirrorScene& scene, float x, float y) {
    return scene.radiance(x, y, first_sphere(scene, x, y));
}

/// Schlick's reflectance where a vertical ray meets a sphere at impact parameter ρ.
double reflectance(double rho, double at_normal) {
    const double cosine = std::sqrt(1 - 4 * rho * rho);
    return at_normal + (1 - at_normal) * std::pow(1 - cosine, 5);
}

TEST(MirrorScene, TheCoreOfALoneSphereSendsRaysUpAndIsDark) {
    const MirrorScene scene({{0, 0, 0.3F}}, kDark);
    for (const float angle : {0.0F, 1.0F, 2.5F, 4.0F}) {
        for (const float rho : {0.0F, 0.2F, kCore - 0.002F}) {
            EXPECT_EQ(seen(scene, rho * std::cos(angle), rho * std::sin(angle)), 0) << rho;
        }
    }
}

TEST(MirrorScene, TheRimOfALoneSphereShowsThePanelByItsReflectance) {
    const MirrorScene scene({{0, 0, 0.3F}}, kDark);
    for (const float angle : {0.0F, 1.0F, 2.5F, 4.0F}) {
        for (const float rho : {kCore + 0.002F, 0.4F, 0.45F, 0.49F}) {
            EXPECT_NEAR(seen(scene, rho * std::cos(angle), rho * std::sin(angle)),
                        reflectance(static_cast<double>(rho), 0.6), 1e-4)
                << rho;
        }
    }
}

TEST(MirrorScene, ARayThatPassesSeesThePanel) {
    const MirrorScene scene({{0, 0, 0.3F}}, kDark);
    EXPECT_EQ(first_sphere(scene, 0.51F, 0), -1);
    EXPECT_EQ(first_at(scene, 0.51F, 0).touched(0).count, 1);
    EXPECT_EQ(first_sphere(scene, 0.6F, 0), -1);
    EXPECT_EQ(first_at(scene, 0.6F, 0).touched(0).count, 0);
    EXPECT_EQ(seen(scene, 0.51F, 0), 1);
    EXPECT_EQ(seen(MirrorScene({}, kDark), 3, 4), 1);
}

TEST(MirrorScene, ARayIsStoppedByASphereBeyondThoseNearTheOneThatMirroredIt) {
    // Almost level from the first sphere, over the second, into the third 4 a away.
    const float rho = kCore + 0.006F;
    const std::vector<Point3> two = {{0, 0, 0}, {2, 0, -0.3F}};
    std::vector<Point3> three = two;
    three.push_back({4, 0, 0.2F});
    EXPECT_GT(4, NearSpheres::kReach);
    EXPECT_NEAR(seen(MirrorScene(two, kDark), rho, 0), reflectance(static_cast<double>(rho), 0.6),
                1e-4);
    EXPECT_LT(seen(MirrorScene(three, kDark), rho, 0), 0.5);
}

TEST(MirrorScene, WhatIsNotThePanelIsSeenAsAmbientLight) {
    MirrorOptics optics = kDark;
    optics.ambient = 0.3;
    EXPECT_NEAR(seen(MirrorScene({{0, 0, 0}}, optics), 0.2F, 0), 0.3 * reflectance(0.2, 0.6), 1e-5);
    // The panel ends at 30° below the horizon: a reflected ray descends by 2 c² − 1 = −1/2 at
    // c² = 1/4, ρ = R sqrt(3)/2.
    optics.grazing = 0.5;
    const MirrorScene scene({{0, 0, 0}}, optics);
    EXPECT_NEAR(seen(scene, 0.43F, 0), 0.3 * reflectance(0.43, 0.6), 1e-4);
    EXPECT_NEAR(seen(scene, 0.436F, 0), reflectance(0.436, 0.6), 1e-4);
}

TEST(MirrorScene, ANeighbourDarkensTheRimTowardsItAndNoOther) {
    const MirrorScene lone({{0, 0, 0.5F}}, kDark);
    const MirrorScene pair({{0, 0, 0.5F}, {1.1F, 0, 0.4F}}, kDark);
    for (const float rho : {0.38F, 0.42F}) {
        EXPECT_LT(seen(pair, rho, 0), 0.65F * seen(lone, rho, 0)) << rho;
        EXPECT_EQ(seen(pair, -rho, 0), seen(lone, -rho, 0)) << rho;
    }
}

TEST(MirrorScene, TheHigherOfTwoSpheresHidesTheOther) {
    const MirrorScene scene({{0, 0, 0}, {0.5F, 0, 0.9F}}, kDark);
    EXPECT_EQ(first_sphere(scene, 0.25F, 0), 1);
    EXPECT_EQ(first_sphere(scene, -0.1F, 0), 0);
}

/// The plain search: every sphere, by the line from the eye through (x, y, 0); in double precision.
std::int32_t first_of_all(const std::vector<Point3>& spheres, const MirrorOptics& optics, float x,
                          float y, bool& is_close) {
    const double far = optics.distance > 0 ? optics.distance : 1e9;
    const double eye[3] = {optics.distance > 0 ? optics.middle_x : static_cast<double>(x),
                           optics.distance > 0 ? optics.middle_y : static_cast<double>(y), far};
    const double dx = static_cast<double>(x) - eye[0];
    const double dy = static_cast<double>(y) - eye[1];
    const double length = std::sqrt(dx * dx + dy * dy + far * far);
    std::int32_t first = -1;
    double nearest = 1e300;
    is_close = false;
    for (std::size_t i = 0; i < spheres.size(); ++i) {
        // From where the line meets z = 0: numbers stay small.
        const double ox = static_cast<double>(spheres[i].x - x);
        const double oy = static_cast<double>(spheres[i].y - y);
        const double oz = static_cast<double>(spheres[i].z);
        const double along = (ox * dx + oy * dy - oz * far) / length;
        const double inside = 0.25 - (ox * ox + oy * oy + oz * oz - along * along);
        is_close = is_close || std::abs(inside) < 1e-5;
        if (inside <= 0) continue;
        const double at = along - std::sqrt(inside);
        is_close = is_close || std::abs(at - nearest) < 1e-5;
        if (at >= nearest) continue;
        nearest = at;
        first = static_cast<std::int32_t>(i);
    }
    return first;
}

TEST(MirrorScene, ARowMeetsFirstWhatThePlainSearchFindsWithPerspectiveToo) {
    const std::vector<Point3> spheres = grainfield::testing::rendered_layer(9, 12, 0, 5).spheres;
    for (const double distance : {0.0, 40.0, 12.0}) {
        MirrorOptics optics = kDark;
        optics.distance = distance;
        optics.middle_x = 2;
        optics.middle_y = 5;
        const MirrorScene scene(spheres, optics);
        std::vector<float> x;
        for (int k = 0; k < 333; ++k) x.push_back(-0.7F + 0.0271F * static_cast<float>(k));
        FirstSpheres row;
        int met = 0;
        for (int v = 0; v < 50; ++v) {
            const float y = -0.6F + 0.171F * static_cast<float>(v);
            scene.first_spheres(x, y, true, row);
            for (std::size_t k = 0; k < x.size(); ++k) {
                bool is_close = false;
                const std::int32_t expected = first_of_all(spheres, optics, x[k], y, is_close);
                if (!is_close) {
                    EXPECT_EQ(row.first[k], expected) << x[k] << ' ' << y << ' ' << distance;
                }
                met += expected >= 0 ? 1 : 0;
            }
        }
        EXPECT_GT(met, 5000);
    }
}

TEST(MirrorScene, AMovedSphereIsSeenAsInASceneBuiltThere) {
    const std::vector<Point3> spheres{
        {0, 0, 0.1F}, {0.7F, 0.3F, 0.85F}, {-0.5F, 0.9F, 0.5F}, {0.2F, -1.05F, 0.2F}};
    const MovedSphere moved{1, {0.72F, 0.29F, 0.8F}};
    std::vector<Point3> displaced = spheres;
    displaced[1] = moved.centre;
    const MirrorScene scene(spheres, {});
    const MirrorScene there(displaced, {});
    int changed = 0;
    for (int row = -30; row <= 30; ++row) {
        for (int column = -30; column <= 30; ++column) {
            const float x = 0.7F + 0.0301F * static_cast<float>(column);
            const float y = 0.3F + 0.0301F * static_cast<float>(row);
            const float value = scene.radiance(x, y, first_sphere(scene, x, y), moved);
            EXPECT_NEAR(value, seen(there, x, y), 1e-5F) << x << ' ' << y;
            changed += std::abs(value - seen(scene, x, y)) > 0.01F;
        }
    }
    EXPECT_GT(changed, 100);
}

TEST(MirrorScene, ARayTouchesTheSpheresThatItMeetsAndPassesClosely) {
    const MirrorScene scene({{0, 0, 0.5F}, {1.1F, 0, 0.4F}, {0, 2, 0.5F}}, kDark);
    TouchedSpheres touched;
    scene.radiance(0.38F, 0, 0, touched);
    EXPECT_EQ(std::vector<std::int32_t>(touched.id, touched.id + touched.count),
              (std::vector<std::int32_t>{0, 1}));
}

TEST(MirrorScene, ACameraAboveTheMiddleSeesSpheresDisplacedOutwards) {
    MirrorOptics optics = kDark;
    optics.distance = 50;
    // A centre at z = 0.5 is seen where the line from (0, 0, 50) through it meets z = 0.
    const MirrorScene scene({{10, 0, 0.5F}}, optics);
    const float seen_at = 10 * 50 / 49.5F;
    EXPECT_EQ(first_sphere(scene, seen_at, 0), 0);
    // The silhouette's half width along y is R · 50/49.5 at this inclination, to a percent.
    EXPECT_EQ(first_sphere(scene, seen_at, 0.495F), 0);
    EXPECT_EQ(first_sphere(scene, seen_at, 0.515F), -1);
}

}  // namespace
}  // namespace grainfield::tracking
