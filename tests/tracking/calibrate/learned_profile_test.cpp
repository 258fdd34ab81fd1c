#include "tracking/calibrate/learned_profile.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/layer_frames.h"
#include "tests/support/position_score.h"
#include "tests/support/pull.h"
#include "tracking/calibrate/calibration.h"

namespace grainfield::tracking {
namespace {

using testing::LayerScene;
using testing::score_positions;

const DiscProfile kDisc{16, 1.2};

/// How much darker than tanh a sphere of these frames is: a bright rim, and a shadow outside it.
double rim(double r) {
    const auto bump = [r](double at, double width) {
        return std::exp(-(r - at) * (r - at) / (2 * width * width));
    };
    return -0.16 * bump(6.2, 1.0) + 0.06 * bump(9.6, 0.8);
}

/// Transmissions of spheres with that profile, multiplied; background 200, core 30, `noise` of the
/// contrast.
Image rim_frame(const LayerScene& scene, double noise) {
    Image light(scene.width, scene.height, 1.0F);
    constexpr double kReach = 14;
    for (const Vec2 p : scene.position) {
        const int y1 = std::min(scene.height - 1, static_cast<int>(p.y + kReach));
        const int x1 = std::min(scene.width - 1, static_cast<int>(p.x + kReach));
        for (int y = std::max(0, static_cast<int>(p.y - kReach)); y <= y1; ++y) {
            for (int x = std::max(0, static_cast<int>(p.x - kReach)); x <= x1; ++x) {
                const double r = std::hypot(x - p.x, y - p.y);
                light(x, y) *= static_cast<float>(1 - kDisc.darkness(r) - rim(r));
            }
        }
    }
    RandomStream random(3, "rim frame");
    for (float& v : light.pixels()) {
        v = static_cast<float>(
            std::round(30 + 170 * (static_cast<double>(v) + noise * random.normal())));
    }
    return light;
}

std::optional<Calibration> calibrated(const Image& frame, Learning learning, RunPlan& plan) {
    CalibrationOptions options;
    options.profile.learning = learning;
    return calibrate(frame, options, {}, {}, 2, plan);
}

struct Outcome {
    double rms = 0;
    double pull = 0;
    bool is_learned = false;
    std::int64_t wrong = 0;
};

Outcome tracked(const Image& frame, const LayerScene& scene, Learning learning) {
    RunPlan plan;
    const auto calibration = calibrated(frame, learning, plan);
    if (!calibration) return {};
    const ImageModel& model = calibration->model;
    Locator locator(frame.width(), frame.height(), model, 2);
    const Located found = locator.locate(model.darkness(frame), {}, {}, calibration->positions);
    Outcome outcome;
    const auto s =
        score_positions(found.position, scene.position, 4, scene.width, scene.height, 16);
    outcome.rms = s.rms;
    outcome.wrong = s.missed + s.spurious;
    outcome.is_learned = !model.correction.is_zero();
    testing::Pull pull;
    for (std::size_t i = 0; i < found.position.size(); ++i) {
        const Vec2 p = found.position[i];
        const auto nearest = std::min_element(
            scene.position.begin(), scene.position.end(),
            [p](Vec2 a, Vec2 b) { return squared_norm(a - p) < squared_norm(b - p); });
        if (norm(*nearest - p) > 4) continue;
        const double error = std::max(found.noise, found.residual[i]);
        pull.add((p.x - nearest->x) / (error * found.error[i].x));
        pull.add((p.y - nearest->y) / (error * found.error[i].y));
    }
    outcome.pull = pull.width();
    return outcome;
}

std::string said_of_profile(const RunPlan& plan) {
    for (const PlannedStage& stage : plan.stages()) {
        if (stage.stage == "profile") return stage.reason;
    }
    return {};
}

TEST(LearnedProfile, FindsAProfileThatIsKnown) {
    const auto scene = testing::hard_disc_liquid(500, 500, 20, 0.45, 1);
    const Image frame = rim_frame(scene, 0.02);
    RunPlan plan;
    const auto calibration = calibrated(frame, Learning::automatic, plan);
    ASSERT_TRUE(calibration);
    const ImageModel& model = calibration->model;
    ASSERT_FALSE(model.correction.is_zero()) << said_of_profile(plan);
    EXPECT_EQ(said_of_profile(plan).rfind("learned", 0), 0u);
    for (double r = 2; r < 11; r += 0.25) {
        const double learned =
            model.disc.darkness(r) + static_cast<double>(model.correction(static_cast<float>(r)));
        // As counts: where darkness is 0 and 1 is a matter of calibration.
        const double clear = model.background(250, 250);
        EXPECT_NEAR(clear - (clear - model.dark_level) * learned,
                    200 - 170 * (kDisc.darkness(r) + rim(r)), 0.012 * 170)
            << r;
    }
}

TEST(LearnedProfile, IsTheResidualOfSpheresThatStandAlone) {
    const auto scene = testing::isolated_discs(640, 640, 16, 32, 1);
    RandomStream random(5, "residual");
    Image residual(640, 640);
    for (float& v : residual.pixels()) v = static_cast<float>(0.02 * random.normal());
    // Noise teaches nothing …
    const LearnedProfile noise = learn_profile(residual, scene.position, kDisc);
    EXPECT_TRUE(noise.is_sampled());
    EXPECT_LT(noise.error, 0.001);
    EXPECT_LT(noise.correction.largest(), 0.003);
    // … and a rim is found to its error, up to the chords of a table w/4 fine.
    for (const Vec2 p : scene.position) {
        for (int y = std::max(0, static_cast<int>(p.y) - 12);
             y < std::min(640, static_cast<int>(p.y) + 13); ++y) {
            for (int x = std::max(0, static_cast<int>(p.x) - 12);
                 x < std::min(640, static_cast<int>(p.x) + 13); ++x) {
                residual(x, y) += static_cast<float>(rim(std::hypot(x - p.x, y - p.y)));
            }
        }
    }
    const LearnedProfile learned = learn_profile(residual, scene.position, kDisc);
    for (float r = 3; r < 11; r += 0.1F) {
        EXPECT_NEAR(learned.correction(r), rim(static_cast<double>(r)), 5 * learned.error) << r;
    }
    EXPECT_NEAR(learned.correction(static_cast<float>(kDisc.reach())), 0, 1e-6F);
}

TEST(LearnedProfile, BringsSpheresWithARimToTheirPlaces) {
    const auto scene = testing::hard_disc_liquid(600, 600, 15, 0.6, 2);
    const Image frame = rim_frame(scene, 0.02);
    const Outcome tanh = tracked(frame, scene, Learning::never);
    const Outcome learned = tracked(frame, scene, Learning::always);
    const Outcome automatic = tracked(frame, scene, Learning::automatic);
    EXPECT_FALSE(tanh.is_learned);
    EXPECT_TRUE(learned.is_learned);
    EXPECT_TRUE(automatic.is_learned);
    EXPECT_EQ(learned.wrong, 0);
    // 0.0142 and 0.0220 px; both say how large their errors are.
    EXPECT_LT(learned.rms, 0.7 * tanh.rms);
    EXPECT_LT(learned.pull, 1.15);
    EXPECT_EQ(automatic.rms, learned.rms);
}

// A camera that knows nothing of tanh, nor of products.
TEST(LearnedProfile, HelpsWhereAnotherCameraSeesARim) {
    const auto scene = testing::hard_disc_liquid(600, 600, 16, 0.7, 2);
    const Image frame = testing::camera_frame(scene, {}, 2);
    const Outcome tanh = tracked(frame, scene, Learning::never);
    const Outcome learned = tracked(frame, scene, Learning::always);
    // 0.0106 and 0.0185 px.
    EXPECT_LT(learned.rms, 0.7 * tanh.rms);
    EXPECT_LE(tracked(frame, scene, Learning::automatic).rms, tanh.rms);
}

TEST(LearnedProfile, TanhFramesKeepTanhAndLoseNothingWithoutIt) {
    const auto scene = testing::hard_disc_liquid(600, 600, 16, 0.65, 2);
    const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 2);
    const Outcome tanh = tracked(frame, scene, Learning::never);
    const Outcome learned = tracked(frame, scene, Learning::always);
    EXPECT_FALSE(tracked(frame, scene, Learning::automatic).is_learned);
    EXPECT_EQ(learned.wrong, 0);
    EXPECT_LT(learned.rms, 1.02 * tanh.rms);
}

TEST(LearnedProfile, TooFewExposedPixelsLeaveTanhAndSaySo) {
    LayerScene scene;
    scene.width = scene.height = 200;
    scene.diameter = 16;
    scene.position = {{50.2, 50.7}, {120.4, 140.1}};
    const Image frame = rim_frame(scene, 0.02);
    RunPlan plan;
    const auto calibration = calibrated(frame, Learning::automatic, plan);
    ASSERT_TRUE(calibration);
    EXPECT_TRUE(calibration->model.correction.is_zero());
    EXPECT_NE(said_of_profile(plan).find("too few pixels"), std::string::npos);
    EXPECT_TRUE(plan.warnings().empty());
    RunPlan forced;
    ASSERT_TRUE(calibrated(frame, Learning::always, forced));
    ASSERT_EQ(forced.warnings().size(), 1u);
    EXPECT_NE(forced.warnings()[0].text.find("no profile was learned"), std::string::npos);
}

}  // namespace
}  // namespace grainfield::tracking
