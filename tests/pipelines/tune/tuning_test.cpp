#include "pipelines/tune/tuning.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

struct Seen : ::testing::Test {
    Seen() {
        model.disc.diameter = 9;
        surveys.resize(2);
        surveys[0].found.position = {{1, 1}, {2, 2}, {3, 3}};
        surveys[0].found.residual_rms = 0.02;
        surveys[0].found.noise = 0.01;
        surveys[1].found.position = {{1, 1}};
        surveys[1].found.residual_rms = 0.04;
        surveys[1].found.noise = 0.02;
    }
    tracking::ImageModel model;
    tracking::TrackOptions options;
    std::vector<tracking::Survey> surveys;
    const Tuning tuning{model, options, surveys};
};

TEST_F(Seen, MeansAreOverTheFrames) {
    EXPECT_DOUBLE_EQ(tuning.particles_mean(), 2);
    EXPECT_DOUBLE_EQ(tuning.residual_rms(), 0.03);
    EXPECT_DOUBLE_EQ(tuning.noise(), 0.015);
    surveys.clear();
    EXPECT_EQ(tuning.particles_mean(), 0);
}

TEST_F(Seen, LengthsAreInSpheresOnceTheirDiameterIsKnown) {
    EXPECT_EQ(tuning.diameter(), 9);
    options.sphere_diameter = 10.2;
    EXPECT_EQ(tuning.diameter(), 10.2);
}

TEST_F(Seen, TheCellForbidsDistancesThatItsHeightDoesNotLeave) {
    EXPECT_EQ(tuning.forbidden_distance(), 0);
    options.layers.height = 1.94;
    EXPECT_EQ(tuning.forbidden_distance(), 0) << "the height is in a, which is not known";
    options.sphere_diameter = 10;
    // One sphere at each plate: their centres are 0.94 a apart in height.
    EXPECT_NEAR(tuning.forbidden_distance(), 10 * std::sqrt(1 - 0.94 * 0.94), 1e-12);
}

TEST_F(Seen, TheMedianErrorIsThatPerAxisOfAllSpheresWithOne) {
    EXPECT_TRUE(std::isnan(tuning.median_error()));
    const double nan = std::numeric_limits<double>::quiet_NaN();
    surveys[0].error = {{0.03, 0.04}, {nan, nan}, {0.3, 0.4}};
    surveys[1].error = {{0.003, 0.004}};
    EXPECT_NEAR(tuning.median_error(), 0.05 / std::sqrt(2.0), 1e-12);
}

TEST_F(Seen, GatheredIsOneValueASphereInTheOrderOfTheFrames) {
    const auto x = tuning.gathered([](const tracking::Survey& survey) {
        std::vector<double> values;
        for (const Vec2 p : survey.found.position) values.push_back(p.x);
        return values;
    });
    EXPECT_EQ(x, (std::vector<double>{1, 2, 3, 1}));
}

}  // namespace
}  // namespace grainfield::pipelines
