#include "pipelines/validate/random/scene_score.h"

#include <cmath>

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

/// Ten pixels a sphere: D = 8.8 px, pairs within 2.2 px.
SeenScene scene_of(std::vector<Vec2> truth, std::vector<Vec2> found) {
    SeenScene scene;
    scene.score.drawn.scale = 10;
    scene.frame.image = Image(100, 80);
    scene.truth.position = std::move(truth);
    scene.found.position = std::move(found);
    scene.found.position_error.assign(scene.found.position.size(), Vec2{0.1, 0.2});
    return scene;
}

TEST(SceneScore, CountsWhatIsInsideTheBorderAndMarksItsErrors) {
    // Errors of the two pairs: (0.3, 0) and (0, −0.1). The third is missed, the fourth is in the
    // border and matched, the fifth is in the border and missed.
    SeenScene scene = scene_of({{30, 30}, {50, 30}, {70, 30}, {5, 40}, {50, 75}},
                               {{30.3, 30}, {50, 29.9}, {40, 42}, {5.1, 40}, {73, 30}, {3, 55}});
    score_scene(scene);
    EXPECT_EQ(scene.score.spheres, 3);
    EXPECT_EQ(scene.score.missed, 1);
    EXPECT_EQ(scene.score.spurious, 2) << "(3, 55) belongs to the border";
    EXPECT_NEAR(scene.score.rmse, std::sqrt((0.09 + 0.01) / 4) / 10, 1e-12);
    EXPECT_NEAR(scene.score.pull_rms, std::sqrt((9 + 0.25) / 4), 1e-12);
    EXPECT_DOUBLE_EQ(scene.score.within, 0.75) << "one of four errors is three standard errors";
    ASSERT_EQ(scene.missed.size(), 1);
    EXPECT_EQ(scene.missed[0].x, 70);
    ASSERT_EQ(scene.spurious.size(), 2);
    EXPECT_EQ(scene.spurious[0].x, 40);
    EXPECT_EQ(scene.spurious[1].x, 73);
    EXPECT_DOUBLE_EQ(scene.score.recall(), 2.0 / 3);
    EXPECT_DOUBLE_EQ(scene.score.false_share(), 2.0 / 3);
}

TEST(SceneScore, OfNothingFoundIsARecallOfZeroWithoutAnError) {
    SeenScene scene = scene_of({{30, 30}, {50, 30}}, {});
    score_scene(scene);
    EXPECT_EQ(scene.score.recall(), 0);
    EXPECT_EQ(scene.score.false_share(), 0);
    EXPECT_TRUE(std::isnan(scene.score.rmse));
    EXPECT_TRUE(std::isnan(scene.score.within));
    EXPECT_EQ(scene.missed.size(), 2);
}

TEST(SceneScore, ASmallSceneIsSeenTheSameWayTwice) {
    DrawnScene drawn = draw_scene(1, 0, SceneSize::small);
    drawn.spheres = 150;
    drawn.scale = 10;
    const SeenScene a = see_scene(drawn, 0, {});
    const SeenScene b = see_scene(drawn, 0, {});
    EXPECT_EQ(a.frame.image, b.frame.image);
    ASSERT_EQ(a.found.size(), b.found.size());
    for (std::size_t i = 0; i < a.found.size(); ++i) {
        EXPECT_EQ(a.found.position[i].x, b.found.position[i].x);
        EXPECT_EQ(a.found.position[i].y, b.found.position[i].y);
    }
    EXPECT_TRUE(a.score.is_calibrated);
    EXPECT_GT(a.score.spheres, 80);
    EXPECT_GT(a.score.recall(), 0.97);
    EXPECT_GT(a.score.us_per_sphere, 0);
    // Steel over a panel looks smaller than it is, but not by half.
    EXPECT_GT(a.score.disc.diameter, 6);
    EXPECT_LT(a.score.disc.diameter, 11);
    drawn.seed += 1;
    EXPECT_FALSE(see_scene(drawn, 0, {}).frame.image == a.frame.image);
}

TEST(SceneScore, WritesItsCameraAsToml) {
    DrawnScene drawn;
    drawn.scale = 12.25;
    const std::string text = toml_of(drawn);
    EXPECT_NE(text.find("scale = 12.25  # [px/a]\n"), std::string::npos) << text;
    EXPECT_NE(text.find("panel-distance = 10  # [a]\n"), std::string::npos);
    EXPECT_NE(text.find("walls-seen = true\n"), std::string::npos);
    EXPECT_EQ(text.find("crystal"), std::string::npos);
    drawn.crystal = {.share = 0.25, .spacing = 0.8, .periods = 3};
    const std::string crystal = toml_of(drawn);
    EXPECT_NE(crystal.find("crystal-share = 0.25  # [of the area]\n"), std::string::npos);
    EXPECT_NE(crystal.find("crystal-periods = 3  # [-]\n"), std::string::npos) << crystal;
}

}  // namespace
}  // namespace grainfield::pipelines
