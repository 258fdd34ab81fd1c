#include "tracking/synthesis/bias_terms.h"

#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

constexpr int kSide = 41;
constexpr double kDiameter = 12;
constexpr Vec2 kMiddle{20, 20};

/// A picture with its discs.
struct Scene {
    Image darkness{kSide, kSide}, residual{kSide, kSide};
    std::vector<Vec2> discs;

    BiasTerms::Terms terms() const {
        return BiasTerms(darkness, residual, discs, kDiameter).of(kMiddle);
    }
};

Scene random_scene() {
    Scene scene;
    RandomStream random(3, "scene");
    for (Image* image : {&scene.darkness, &scene.residual}) {
        for (float& v : image->pixels()) v = static_cast<float>(random.normal());
    }
    scene.discs.push_back(kMiddle);
    for (int i = 0; i < 6; ++i) {
        scene.discs.push_back({random.uniform(0, kSide - 1), random.uniform(0, kSide - 1)});
    }
    return scene;
}

/// `to`: where (x, y) about the middle goes.
Scene transformed(const Scene& scene, const std::function<Vec2(Vec2)>& to) {
    Scene other;
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const Vec2 q = to(Vec2{x * 1.0, y * 1.0} - kMiddle) + kMiddle;
            const int u = static_cast<int>(std::lround(q.x));
            const int v = static_cast<int>(std::lround(q.y));
            other.darkness(u, v) = scene.darkness(x, y);
            other.residual(u, v) = scene.residual(x, y);
        }
    }
    for (const Vec2 p : scene.discs) other.discs.push_back(to(p - kMiddle) + kMiddle);
    return other;
}

void expect_vectors(const std::function<Vec2(Vec2)>& to) {
    const Scene scene = random_scene();
    const BiasTerms::Terms before = scene.terms();
    const BiasTerms::Terms after = transformed(scene, to).terms();
    for (std::size_t k = 0; k < BiasTerms::kCount; ++k) {
        const Vec2 expected =
            to({static_cast<double>(before.x[k]), static_cast<double>(before.y[k])});
        // Single precision over 24 values of order one.
        EXPECT_NEAR(static_cast<double>(after.x[k]), expected.x, 2e-5) << k;
        EXPECT_NEAR(static_cast<double>(after.y[k]), expected.y, 2e-5) << k;
    }
}

TEST(BiasTerms, TurnWithThePicture) {
    expect_vectors([](Vec2 p) { return Vec2{-p.y, p.x}; });
}

TEST(BiasTerms, AreMirroredWithThePicture) {
    expect_vectors([](Vec2 p) { return Vec2{p.x, -p.y}; });
}

TEST(BiasTerms, OfNeighboursPointAtThem) {
    Scene scene;
    scene.discs = {kMiddle, kMiddle + Vec2{0.8 * kDiameter, 0}};
    const BiasTerms::Terms terms = scene.terms();
    int pointing = 0;
    for (std::size_t k = 0; k < BiasTerms::kDistances; ++k) {
        pointing += terms.x[k] > 0;
        EXPECT_EQ(terms.y[k], 0);
    }
    EXPECT_EQ(pointing, 1) << "a distance at a knot has one term";
}

TEST(BiasTerms, NearestLeavesTheSphereItselfOut) {
    const Scene scene;
    const std::vector<Vec2> discs{kMiddle, kMiddle + Vec2{6, 0}, kMiddle + Vec2{0, 9}};
    const BiasTerms terms(scene.darkness, scene.residual, discs, kDiameter);
    EXPECT_DOUBLE_EQ(terms.nearest(kMiddle), 0.5);
}

TEST(BiasTerms, WeightedIsTheSumOverAllTerms) {
    const Scene scene = random_scene();
    RandomStream random(4, "weights");
    std::vector<double> weights;
    for (int k = 0; k < BiasTerms::kCount; ++k) weights.push_back(random.normal());
    const BiasTerms::Terms terms = scene.terms();
    Vec2 sum{0, 0};
    double size = 0;
    for (std::size_t k = 0; k < weights.size(); ++k) {
        const Vec2 term =
            weights[k] * Vec2{static_cast<double>(terms.x[k]), static_cast<double>(terms.y[k])};
        sum += term;
        size += norm(term);
    }
    const BiasTerms quick(scene.darkness, scene.residual, scene.discs, kDiameter);
    const auto [value, nearest] = quick.weighted(kMiddle, BiasTerms::Weights(weights));
    EXPECT_NEAR(value.x, sum.x, 1e-6 * size);
    EXPECT_NEAR(value.y, sum.y, 1e-6 * size);
    EXPECT_DOUBLE_EQ(nearest, quick.nearest(kMiddle));
    EXPECT_GT(norm(sum), 1e-3 * size);
}

}  // namespace
}  // namespace grainfield::tracking
