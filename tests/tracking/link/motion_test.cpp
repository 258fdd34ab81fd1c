#include "tracking/link/motion.h"

#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

const std::vector<Track> kTracks{{0, 4, {10, 10}, {}, Vec2{1, 0}},
                                 {1, 5, {12, 10}, {}, std::nullopt},
                                 {2, 5, {90, 10}, {}, std::nullopt},
                                 {3, 5, {13, 10}, {}, Vec2{0, -2}}};

TEST(Motion, WithoutAPredictorTracksStayWhereTheyWere) {
    const auto place = predict(kTracks, 6, Predictor::none, {5, 5}, 10);
    for (std::size_t i = 0; i < kTracks.size(); ++i) EXPECT_EQ(place[i], kTracks[i].position);
}

TEST(Motion, DriftMovesAllTracksForEveryFrameTheyWereMissing) {
    const auto place = predict(kTracks, 6, Predictor::drift, {0.5, -1}, 10);
    EXPECT_EQ(place[0], (Vec2{11, 8}));  // two frames
    EXPECT_EQ(place[1], (Vec2{12.5, 9}));
}

TEST(Motion, ANewTrackTakesTheVelocityOfItsNearestNeighbourElseTheDrift) {
    const auto place = predict(kTracks, 6, Predictor::nearest_velocity, {7, 7}, 10);
    EXPECT_EQ(place[0], (Vec2{12, 10}));
    EXPECT_EQ(place[3], (Vec2{13, 8}));
    EXPECT_EQ(place[1], (Vec2{12, 8}));   // track 3 is 1 px away, track 0 is 2 px away
    EXPECT_EQ(place[2], (Vec2{97, 17}));  // none within 10 px
}

TEST(Motion, TheMedianIgnoresTwoWildVelocitiesOfFive) {
    EXPECT_EQ(median({{1, 5}, {1e6, -1e9}, {2, 4}, {-1e6, 1e9}, {1.5, 4.5}}), (Vec2{1.5, 4.5}));
    EXPECT_EQ(median({}), (Vec2{0, 0}));
}

TEST(Motion, TheVarianceOfTheMotionIsFoundUnderUnequalErrorsAndWrongLinks) {
    RandomStream random(1, "motion");
    std::vector<SeenStep> steps;
    for (int i = 0; i < 1000; ++i) {
        const double e2 = i % 3 == 0 ? 8.0 : 0.02;
        const double sigma = std::sqrt(0.18 + e2);
        const Vec2 step = sigma * Vec2{random.normal(), random.normal()};
        steps.push_back({i % 50 == 0 ? 30.0 : squared_norm(step), e2});
    }
    // The median of 1,000 exponentials is known to 4.6 %, of which two thirds know of s²; 2 % of
    // wrong links raise it by 4 %: five standard deviations and that.
    EXPECT_NEAR(motion_variance(steps), 0.18, 0.18 * (5 * 0.07 + 0.06));
    EXPECT_EQ(motion_variance({}), 0);
    EXPECT_LT(motion_variance({{0.01, 4.0}, {0.02, 4.0}}), 1e-9);
    EXPECT_EQ(motion_variance({{0.0, 0.0}, {0.0, 0.0}}), 0);
}

}  // namespace
}  // namespace grainfield::tracking
