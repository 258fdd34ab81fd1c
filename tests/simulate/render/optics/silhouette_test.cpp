#include "simulate/render/optics/silhouette.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/simulate/render/render_scenes.h"

namespace grainfield::simulate {
namespace {

// The share of n × n points of a pixel that no disc covers.
double open_share(const std::vector<Disc>& discs, int x, int y, int n) {
    int open = 0;
    for (int j = 0; j < n; ++j) {
        for (int i = 0; i < n; ++i) {
            const Vec2 p{x - 0.5 + (i + 0.5) / n, y - 0.5 + (j + 0.5) / n};
            open += std::none_of(discs.begin(), discs.end(), [&](const Disc& d) {
                return squared_norm(p - d.centre) < d.radius * d.radius;
            });
        }
    }
    return static_cast<double>(open) / (n * n);
}

void expect_supersampled(const SphereScene& scene, const View& view) {
    SilhouetteOptics optics({}, 1);
    const Image image = optics.radiance(scene, view);
    std::vector<Disc> discs;
    for (const Vec3 p : scene.centre) discs.push_back(silhouette_of(p, view));
    for (int y = 0; y < view.height(); ++y) {
        for (int x = 0; x < view.width(); ++x) {
            // Counting 64 × 64 points of a smooth edge is good to a few 1e-3.
            ASSERT_NEAR(image(x, y), open_share(discs, x, y, 64), 6e-3) << x << ' ' << y;
        }
    }
}

TEST(Silhouette, OverlappingDiscsAgreeWithSupersampling) {
    expect_supersampled(random_scene(25, 5, 1.94, 7), square_view(60, 5, Projection::telecentric));
    expect_supersampled(crystal_scene(6, 0.81, 1.94), square_view(60, 5, Projection::perspective));
}

TEST(Silhouette, SpheresOfThreePixelsAgreeWithSupersampling) {
    expect_supersampled(random_scene(300, 20, 1.94, 8),
                        square_view(60, 20, Projection::perspective));
}

TEST(Silhouette, ClosePackedBilayerIsBlackAndTheHolesOfOthersAreOfKnownSize) {
    // Open part of a unit cell at spacing s: 1 − (π/4 − overlap lenses of 4 pairs / 2)/s².
    for (const double s : {0.7071067811865476, 0.75, 0.81}) {
        SilhouetteOptics optics({}, 1);
        const int cells = 40;
        const SphereScene scene = crystal_scene(cells, s, 1.94);
        const Image image =
            optics.radiance(scene, square_view(800, cells * s, Projection::telecentric));
        double open = 0;
        int pixels = 0;
        for (int y = 200; y < 600; ++y) {
            for (int x = 200; x < 600; ++x, ++pixels) open += static_cast<double>(image(x, y));
        }
        const double lens = std::acos(s) / 2 - s / 2 * std::sqrt(1 - s * s);
        const double expected = 1 - (std::numbers::pi / 4 - 2 * lens) / (s * s);
        EXPECT_NEAR(open / pixels, std::max(0.0, expected), 2e-5 + 1e-3 * expected) << s;
    }
}

TEST(Silhouette, IsTheSameForAnyNumberOfThreads) {
    for (const double rim : {0.0, 0.4}) {
        const SphereScene scene = random_scene(500, 20, 1.94, 9);
        const View view = square_view(300, 20, Projection::perspective);
        SilhouetteOptics one({.rim = rim}, 1);
        const Image reference = one.radiance(scene, view);
        for (const int threads : {2, 8}) {
            SilhouetteOptics many({.rim = rim}, threads);
            EXPECT_EQ(reference, many.radiance(scene, view));
        }
    }
}

TEST(Silhouette, ARimIsBrightOnlyOutsideTheCore) {
    SphereScene scene;
    scene.centre = {{5, 5, 0.5}};
    SilhouetteOptics optics({.rim = 0.4}, 1);
    const View view = square_view(1000, 10, Projection::telecentric);
    const Image image = optics.radiance(scene, view);
    const double radius = 50;
    for (const double part : {0.0, 0.5, 0.69})
        EXPECT_EQ(image(static_cast<int>(500 + part * radius), 500), 0);
    for (const double part : {0.74, 0.9, 0.96}) {
        EXPECT_FLOAT_EQ(image(static_cast<int>(500 + part * radius), 500), 0.4F);
    }
    EXPECT_EQ(image(552, 500), 1);
}

TEST(Silhouette, NothingMakesAnEvenField) {
    SilhouetteOptics optics({}, 2);
    const Image image =
        optics.radiance(SphereScene{}, square_view(100, 10, Projection::perspective));
    for (const float value : image.pixels()) ASSERT_EQ(value, 1);
}

TEST(Silhouette, OfALargeSphereIsThatOfASmallOneEnlarged) {
    SphereScene scene;
    scene.centre = {{2, 2, 0.97}};
    SilhouetteOptics optics({}, 1);
    const Image image = optics.radiance(scene, square_view(800, 4, Projection::telecentric));
    double dark = 0;
    for (const float value : image.pixels()) dark += 1 - static_cast<double>(value);
    EXPECT_NEAR(dark, std::numbers::pi * 1e4, 1e-2);
}

TEST(Silhouette, PerspectiveMovesTheUpperLayerOutwardsAndEnlargesIt) {
    const View view = square_view(1600, 100, Projection::perspective);
    const Disc low = silhouette_of({100, 50, 0.5}, view);
    const Disc high = silhouette_of({100, 50, 1.44}, view);
    // Δx = 50 a · 0.94 a / 700 a, in pixels of 1/16 a.
    EXPECT_NEAR(high.centre.x - low.centre.x, 16 * 50 * 0.94 / 700, 2e-3);
    EXPECT_NEAR(high.radius / low.radius, 1 + 0.94 / 700, 1e-5);
}

}  // namespace
}  // namespace grainfield::simulate
