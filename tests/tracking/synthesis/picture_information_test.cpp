#include "tracking/synthesis/picture_information.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield::tracking {
namespace {

constexpr double kHeight = 1.94;  // of the cell [a]
constexpr PictureSetting kSmall{.width = 72, .height = 72, .scale = 16, .threads = 2};
constexpr Point3 kMiddle{2.26F, 2.24F, 0.47F};

/// The middle of a small picture, and a camera far away or `distance` above a place 10 a beside it.
MirrorOptics optics(double distance) {
    return {.distance = distance, .middle_x = -7.7, .middle_y = 2.2};
}

/// A pair whose heights differ by `dz`, seen `distance` apart.
std::vector<Point3> pair(float distance, float dz) {
    const float u = 0.5F * distance * std::cos(0.4F);
    const float v = 0.5F * distance * std::sin(0.4F);
    return {{kMiddle.x + u, kMiddle.y + v, kMiddle.z + 0.5F * dz},
            {kMiddle.x - u, kMiddle.y - v, kMiddle.z - 0.5F * dz}};
}

/// Moved by a fifth of a diameter each way: over less, few rays change where only perspective does.
SphereMotion together(std::size_t spheres) {
    SphereMotion motion;
    motion.step = 0.2;
    motion.known_to = anywhere_between(kHeight);
    for (std::size_t i = 0; i < spheres; ++i) {
        motion.sphere.push_back(static_cast<std::int32_t>(i));
        motion.along.push_back({0, 0, 1});
    }
    return motion;
}

/// x, y of both, the height of both together, and the difference of heights.
PictureInformation pair_information(const std::vector<Point3>& spheres, double distance) {
    std::vector<SphereMotion> motions = motions_of({0, 1}, kHeight);
    motions.erase(motions.begin() + 5);
    motions.erase(motions.begin() + 2);
    motions.push_back(together(2));
    motions.push_back(
        {.sphere = {0, 1}, .along = {{0, 0, 0.5F}, {0, 0, -0.5F}}, .step = kHeightStep});
    return {spheres, optics(distance), kSmall, motions};
}

double bound(const PictureInformation& picture, const std::vector<std::size_t>& coordinates,
             std::size_t k) {
    return std::sqrt(picture.covariance(coordinates)[k * coordinates.size() + k]);
}

TEST(PictureInformation, HeightOfALoneSphereLeavesNoTraceWithoutPerspective) {
    std::vector<SphereMotion> motions = motions_of({0}, kHeight);
    motions[2] = together(1);
    const PictureInformation picture({kMiddle}, optics(0), kSmall, motions);
    const PictureInformation::Direction weakest = picture.weakest({0, 1, 2});
    EXPECT_TRUE(std::isinf(weakest.error));
    EXPECT_NEAR(std::abs(weakest.along[2]), 1, 1e-6);
    // Nothing is known of the height but the plates; its place is told to a thousandth.
    EXPECT_NEAR(bound(picture, {0, 1, 2}, 2), 0.94 / std::sqrt(12.0), 1e-3);
    EXPECT_LT(bound(picture, {0, 1, 2}, 0), 1e-3);
}

// A radius of R seen from D above looks larger by R z/D. Its outline tells its radius at least as
// well as its place, σ_x/√2, so that σ_z ≈ √2 σ_x D = .03 a at 60 a and less: mirrored light too
// changes with the direction of view.
TEST(PictureInformation, PerspectiveTellsTheHeightOfALoneSphereByItsSize) {
    std::vector<SphereMotion> motions = motions_of({0}, kHeight);
    motions[2] = together(1);
    MirrorOptics above = optics(60);
    above.middle_x = 2.2;
    const PictureInformation near({kMiddle}, above, kSmall, motions);
    above.distance = 240;
    const PictureInformation far({kMiddle}, above, kSmall, motions);
    EXPECT_LT(bound(near, {0, 1, 2}, 2), 0.06);
    EXPECT_GT(bound(far, {0, 1, 2}, 2), 2 * bound(near, {0, 1, 2}, 2));
}

TEST(PictureInformation, APairTellsItsHeightsRelativeToOneAnother) {
    for (const float distance : {0.7F, 0.9F, 1.1F}) {
        const PictureInformation picture = pair_information(pair(distance, 0.8F), 0);
        const std::vector<std::size_t> all = {0, 1, 2, 3, 4, 5};
        EXPECT_LT(bound(picture, all, 5), 0.02) << distance;
        EXPECT_NEAR(bound(picture, all, 4), anywhere_between(kHeight), 1e-3) << distance;
        const PictureInformation::Direction weakest = picture.weakest(all);
        EXPECT_NEAR(std::abs(weakest.along[4]), 1, 1e-6) << distance;
    }
}

TEST(PictureInformation, APairRaisedTogetherIsTheSamePictureWithoutPerspective) {
    const std::vector<Point3> here = pair(0.8F, 0.8F);
    std::vector<Point3> raised = here;
    for (Point3& p : raised) p.z += 0.1F;
    EXPECT_LT(pair_information(here, 0).rms_from(raised), 1e-4);
    EXPECT_GT(pair_information(here, 60).told_from(raised, {0, 1, 2, 3}), 3);
}

TEST(PictureInformation, ExchangedHeightsOfAnOverlappingPairAreTold) {
    const std::vector<Point3> here = pair(0.7F, 0.8F);
    const std::vector<Point3> exchanged = pair(0.7F, -0.8F);
    for (const double distance : {0.0, 200.0}) {
        const PictureInformation picture = pair_information(here, distance);
        const double before = picture.told_from(exchanged, {});
        const double after = picture.told_from(exchanged, {0, 1, 2, 3});
        EXPECT_GT(after, 30) << distance;
        EXPECT_LT(after, before) << distance;
        EXPECT_NEAR(before, picture.rms_from(exchanged) * 72 / kSmall.noise, 1e-3 * before);
    }
}

TEST(PictureInformation, NeighboursThatAreFreeAreNoHelp) {
    const testing::RenderedLayer layer = testing::rendered_layer(6, 16, 0, 30);
    std::vector<std::int32_t> shown;
    for (std::size_t i = 0; i < layer.spheres.size(); ++i) {
        const Point3& p = layer.spheres[i];
        if (p.x > 0.3F && p.y > 0.3F && p.x < 3.7F && p.y < 3.7F) {
            shown.push_back(static_cast<std::int32_t>(i));
        }
    }
    ASSERT_GT(shown.size(), 8);
    const PictureSetting setting{.width = 64, .height = 64, .rays = 32, .threads = 2};
    const PictureInformation picture(layer.spheres, layer.optics, setting,
                                     motions_of(shown, kHeight));
    std::vector<std::size_t> all;
    for (std::size_t k = 0; k < picture.size(); ++k) all.push_back(k);
    for (std::size_t i = 0; i < shown.size(); ++i) {
        const std::vector<std::size_t> own = {3 * i, 3 * i + 1, 3 * i + 2};
        for (std::size_t q = 0; q < 3; ++q) {
            EXPECT_GE(bound(picture, all, 3 * i + q), bound(picture, own, q) * 0.9999);
        }
    }
}

TEST(PictureInformation, BitsDoNotDependOnTheNumberOfThreads) {
    PictureSetting one = kSmall;
    one.threads = 1;
    const std::vector<Point3> here = pair(0.8F, 0.8F);
    const PictureInformation a(here, optics(0), one, motions_of({0, 1}, kHeight));
    const PictureInformation b(here, optics(0), kSmall, motions_of({0, 1}, kHeight));
    for (std::size_t k = 0; k < a.size(); ++k) {
        for (std::size_t l = 0; l < a.size(); ++l) {
            ASSERT_EQ(a.information(k, l), b.information(k, l));
        }
    }
}

TEST(PictureInformation, WhatNothingTellsIsRefused) {
    std::vector<SphereMotion> motions = motions_of({0}, kHeight);
    motions[2] = together(1);
    motions[2].known_to = std::numeric_limits<double>::infinity();
    const PictureInformation picture({kMiddle}, optics(0), kSmall, motions);
    EXPECT_THROW(picture.covariance({0, 1, 2}), std::domain_error);
    EXPECT_EQ(picture.covariance({0, 1}).size(), 4);
}

TEST(PictureInformation, AMotionWithoutAStepOrOfNoSphereIsRefused) {
    EXPECT_THROW(PictureInformation({kMiddle}, optics(0), kSmall,
                                    {{.sphere = {0}, .along = {{1, 0, 0}}, .step = 0}}),
                 std::invalid_argument);
    EXPECT_THROW(PictureInformation({kMiddle}, optics(0), kSmall, motions_of({1}, kHeight)),
                 std::invalid_argument);
}

}  // namespace
}  // namespace grainfield::tracking
