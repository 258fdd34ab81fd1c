#include "pipelines/validate/random/random_scores.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

SceneScore scene_of(std::int64_t index, std::int64_t missed, std::int64_t spurious, double rmse) {
    SceneScore scene;
    scene.index = index;
    scene.spheres = 100;
    scene.missed = missed;
    scene.spurious = spurious;
    scene.rmse = rmse;
    scene.within = 0.9;
    return scene;
}

const SceneQuantity& quantity(const std::string& key) {
    return *std::find_if(scene_quantities().begin(), scene_quantities().end(),
                         [&](const auto& q) { return q.key == key; });
}

TEST(RandomScores, AreMedianAndWorstOfWhatWasMeasured) {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    std::vector<SceneScore> scenes{scene_of(0, 1, 0, 0.01), scene_of(1, 5, 2, 0.04),
                                   scene_of(2, 0, 0, 0.02)};
    EXPECT_DOUBLE_EQ(spread_of(scenes, quantity("recall")).median, 0.99);
    EXPECT_DOUBLE_EQ(spread_of(scenes, quantity("recall")).worst, 0.95);
    EXPECT_DOUBLE_EQ(spread_of(scenes, quantity("false_share")).worst, 0.02);
    EXPECT_DOUBLE_EQ(spread_of(scenes, quantity("rmse_a")).median, 0.02);
    // One that could not be tracked has no error and recall 0.
    scenes.push_back(scene_of(3, 100, 0, nan));
    EXPECT_DOUBLE_EQ(spread_of(scenes, quantity("rmse_a")).median, 0.02);
    EXPECT_DOUBLE_EQ(spread_of(scenes, quantity("rmse_a")).worst, 0.04);
    EXPECT_DOUBLE_EQ(spread_of(scenes, quantity("recall")).median, 0.97);
    EXPECT_EQ(spread_of(scenes, quantity("recall")).worst, 0);
    EXPECT_TRUE(std::isnan(spread_of({}, quantity("recall")).median));
}

TEST(RandomScores, TheWorstSceneHasMostWrongThenTheGreatestErrorThenTheSmallestNumber) {
    EXPECT_TRUE(is_worse(scene_of(4, 2, 2, 0.01), scene_of(0, 3, 0, 0.05)));
    EXPECT_TRUE(is_worse(scene_of(4, 3, 0, 0.05), scene_of(0, 0, 3, 0.01)));
    EXPECT_TRUE(is_worse(scene_of(0, 3, 0, 0.05), scene_of(4, 3, 0, 0.05)));
    EXPECT_FALSE(is_worse(scene_of(0, 3, 0, 0.05), scene_of(0, 3, 0, 0.05)));
}

TEST(RandomScores, MeetThresholdsInMedianAndWorst) {
    const std::vector<SceneScore> scenes{scene_of(0, 1, 0, 0.01), scene_of(1, 5, 2, 0.04)};
    EXPECT_TRUE(check({}, scenes).empty());
    RandomThresholds thresholds;
    thresholds.median_recall = 0.97;
    thresholds.worst_recall = 0.96;
    thresholds.worst_false = 0.02;
    thresholds.worst_rmse = 0.03;
    thresholds.median_within = 0.92;
    const std::vector<ThresholdCheck> checks = check(thresholds, scenes);
    ASSERT_EQ(checks.size(), 5);
    EXPECT_TRUE(checks[0].met()) << checks[0].text();
    EXPECT_FALSE(checks[1].met()) << checks[1].text();
    EXPECT_TRUE(checks[2].met()) << checks[2].text();
    EXPECT_FALSE(checks[3].met()) << checks[3].text();
    EXPECT_FALSE(checks[4].met()) << checks[4].text();
    EXPECT_FALSE(check(thresholds, {})[0].met()) << "what was not measured is missed";
}

}  // namespace
}  // namespace grainfield::pipelines
