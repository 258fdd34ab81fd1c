#include "tracking/calibrate/calibration.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "io/frame_files.h"
#include "io/frame_region.h"
#include "tests/support/csv_rows.h"
#include "tests/support/layer_frames.h"

namespace grainfield::tracking {
namespace {

using testing::LayerScene;

std::optional<Calibration> calibrated(const Image& frame, RunPlan& plan,
                                      const CalibrationOptions& options = {}) {
    return calibrate(frame, options, {}, {}, 2, plan);
}

TEST(Calibration, FindsDiameterAndEdgeOfALiquid) {
    const auto scene = testing::hard_disc_liquid(500, 500, 16, 0.70, 1);
    const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 2);
    RunPlan plan;
    const auto result = calibrated(frame, plan);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->model.polarity, Polarity::dark);
    EXPECT_NEAR(result->model.disc.diameter, 16, 0.1);
    EXPECT_NEAR(result->model.disc.edge_width, 1.2, 0.1);
    EXPECT_NEAR(result->model.dark_level, 30, 3);
    EXPECT_TRUE(result->model.background.is_uniform());
    EXPECT_TRUE(plan.warnings().empty());
}

TEST(Calibration, IsTheSameForBrightSpheresOnADarkBackground) {
    const auto scene = testing::hard_disc_liquid(400, 400, 14, 0.6, 3);
    const Image dark = testing::tanh_frame(scene, 14, 1.2, 0.02, 2);
    Image bright = dark;
    for (float& v : bright.pixels()) v = 255 - v;
    RunPlan plan;
    const auto a = calibrated(dark, plan);
    const auto b = calibrated(bright, plan);
    ASSERT_TRUE(a && b);
    EXPECT_EQ(b->model.polarity, Polarity::bright);
    EXPECT_NEAR(a->model.disc.diameter, b->model.disc.diameter, 1e-3);
    const Image da = a->model.darkness(dark);
    const Image db = b->model.darkness(bright);
    for (std::size_t i = 0; i < da.size(); i += 97) {
        EXPECT_NEAR(da.pixels()[i], db.pixels()[i], 2e-3);
    }
}

constexpr const char* kAllSpheres = "diameter and edge width of all spheres";

bool runs(const RunPlan& plan, const std::string& name) {
    return std::ranges::any_of(plan.stages(), [&](const PlannedStage& stage) {
        return stage.stage == name && stage.runs;
    });
}

TEST(Calibration, ReadsTheSizeOnAllSpheresWhereDiscsLeaveAMisfit) {
    const auto frames = io::crop_frames(
        io::open_frames({GRAINFIELD_SOURCE_DIR "/data-samples/traced-layer.png"}, {}),
        {.x = 120, .y = 120, .width = 400, .height = 400});
    RunPlan plan;
    const auto result = calibrated(frames->read(0).image, plan);
    ASSERT_TRUE(result);
    EXPECT_TRUE(runs(plan, kAllSpheres));
    EXPECT_TRUE(result->is_complete);
    // Without the search for all of them two are missing.
    std::int64_t inside = 0;
    for (auto& row :
         testing::csv_rows(GRAINFIELD_SOURCE_DIR "/data-samples/traced-layer-true.csv")) {
        const double x = std::stod(row["x"]) - 120;
        const double y = std::stod(row["y"]) - 120;
        if (!(x > 10 && y > 10 && x < 389 && y < 389)) continue;
        ++inside;
    }
    std::int64_t found = 0;
    for (const Vec2 p : result->positions) {
        found += p.x > 10 && p.y > 10 && p.x < 389 && p.y < 389 ? 1 : 0;
    }
    EXPECT_GE(found, inside - 1);
    // Two false ones; where the diameter is known they have no room, and go.
    EXPECT_LE(found, inside + 3);
}

TEST(Calibration, IsContentWithMostSpheresWhereDiscsLeaveOnlyNoise) {
    const auto scene = testing::hard_disc_liquid(500, 500, 16, 0.70, 1);
    RunPlan plan;
    const auto result = calibrated(testing::tanh_frame(scene, 16, 1.2, 0.02, 2), plan);
    ASSERT_TRUE(result);
    EXPECT_FALSE(runs(plan, kAllSpheres));
    EXPECT_FALSE(result->is_complete);
}

// Few spheres leave wide gaps, which must not pass for the spheres.
TEST(Calibration, FindsDarkSpheresInDiluteFrames) {
    for (const double fraction : {0.02, 0.05, 0.11, 0.2}) {
        const auto scene = testing::hard_disc_liquid(600, 600, 16, fraction, 5);
        const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 2);
        RunPlan plan;
        const auto result = calibrated(frame, plan);
        ASSERT_TRUE(result) << fraction;
        EXPECT_EQ(result->model.polarity, Polarity::dark) << fraction;
        EXPECT_NEAR(result->model.disc.diameter, 16, 0.15) << fraction;
        EXPECT_NEAR(result->model.disc.edge_width, 1.2, 0.1) << fraction;
    }
}

TEST(Calibration, TenSpheresOfALargeFrameAreNotBlank) {
    LayerScene scene;
    scene.width = scene.height = 1600;
    scene.diameter = 16;
    for (int i = 0; i < 10; ++i) scene.position.push_back({100.3 + 140.7 * i, 1500.2 - 131.1 * i});
    const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 2);
    EXPECT_EQ(blank_reason(frame), "");
    RunPlan plan;
    const auto result = calibrated(frame, plan);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->model.polarity, Polarity::dark);
    EXPECT_NEAR(result->model.disc.diameter, 16, 0.3);
}

TEST(Calibration, FindsTheSpheresAroundADensePatch) {
    // The holes of such a patch are darker than half the contrast or all but closed: in the
    // thresholded image it is one dark area of a third of the frame.
    for (const double spacing : {0.72, 0.75, 0.78}) {
        for (const double diameter : {8.0, 16.0}) {
            testing::CrystalPatch patch;
            patch.radius = 0.3;
            patch.spacing = spacing;
            patch.clearance = 1;
            const int side = static_cast<int>(40 * diameter);
            const auto scene = testing::crystal_in_liquid(side, side, diameter, 0.72, patch, 1);
            const Image frame = testing::tanh_frame(scene, diameter, 0.075 * diameter, 0.02, 1);
            RunPlan plan;
            const auto result = calibrated(frame, plan);
            ASSERT_TRUE(result) << spacing << ' ' << diameter;
            EXPECT_EQ(result->model.polarity, Polarity::dark);
            EXPECT_NEAR(result->model.disc.diameter, diameter, 0.02) << spacing;
            EXPECT_NEAR(result->model.disc.edge_width, 0.075 * diameter, 0.02) << spacing;
        }
    }
}

TEST(Calibration, ATextureIsNoLayerOfSpheres) {
    // Blobs of one size on average, but no discs.
    for (const double blur : {1.0, 2.0, 4.0}) {
        const Image frame = testing::noise_frame(200, 200, 120, 20, blur, 7);
        RunPlan plan;
        EXPECT_FALSE(calibrated(frame, plan)) << blur;
        ASSERT_EQ(plan.warnings().size(), 1U);
    }
}

// In the gaps between dark discs bright blobs of any number explain as much.
TEST(Calibration, SaysWhatItWeighed) {
    const auto scene = testing::hard_disc_liquid(500, 500, 16, 0.70, 1);
    const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 2);
    RunPlan plan;
    std::vector<SizeCandidate> weighed;
    ASSERT_TRUE(calibrate(frame, {}, {}, {}, 2, plan, {}, &weighed));
    ASSERT_FALSE(weighed.empty());
    const SizeCandidate& best = weighed[choose_size(weighed).best.value()];
    EXPECT_EQ(best.polarity, Polarity::dark);
    EXPECT_GT(best.explained.signal, 0.98);
    EXPECT_GT(best.explained.support, 2);
    EXPECT_EQ(best.position.size(), static_cast<std::size_t>(best.spheres));
    EXPECT_NE(plan.text().find("dark D = 16"), std::string::npos) << plan.text();
}

TEST(Calibration, NamesTheMosaicOfAColourCamera) {
    const auto scene = testing::hard_disc_liquid(400, 400, 16, 0.5, 1);
    Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 2);
    for (int y = 0; y < frame.height(); ++y) {
        for (int x = 0; x < frame.width(); ++x) frame(x, y) *= (x + y) % 2 == 0 ? 0.8F : 1.0F;
    }
    RunPlan plan;
    calibrated(frame, plan);
    ASSERT_FALSE(plan.warnings().empty());
    EXPECT_NE(plan.warnings()[0].text.find("Bayer"), std::string::npos);
}

TEST(Calibration, GivenValuesAreKept) {
    const auto scene = testing::hard_disc_liquid(300, 300, 14, 0.5, 3);
    const Image frame = testing::tanh_frame(scene, 14, 1.2, 0.02, 2);
    CalibrationOptions options;
    options.diameter = 13.5;
    options.edge_width = 1.4;
    options.polarity = PolarityChoice::dark;
    RunPlan plan;
    const auto result = calibrated(frame, plan, options);
    ASSERT_TRUE(result);
    EXPECT_EQ(result->model.disc.diameter, 13.5);
    EXPECT_EQ(result->model.disc.edge_width, 1.4);
    ASSERT_FALSE(plan.skipped().empty());
    EXPECT_EQ(plan.skipped()[0].stage, "polarity");
}

TEST(Calibration, AGivenSizeThatExplainsLittleIsKeptAndTheOneSeenIsAdvised) {
    const auto scene = testing::hard_disc_liquid(500, 500, 16, 0.70, 1);
    const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 2);
    for (const double wrong : {35.0, 21.0}) {
        CalibrationOptions options;
        options.diameter = wrong;
        RunPlan plan;
        std::vector<SizeCandidate> weighed;
        const auto result = calibrate(frame, options, {}, {}, 2, plan, {}, &weighed);
        ASSERT_TRUE(result) << wrong;
        EXPECT_EQ(result->model.disc.diameter, wrong);
        const SizeCandidate& best = weighed[choose_size(weighed).best.value()];
        EXPECT_EQ(best.polarity, Polarity::dark);
        EXPECT_NEAR(best.diameter, 16, 0.2);
        ASSERT_FALSE(plan.warnings().empty());
        EXPECT_NE(plan.warnings()[0].text.find("dark discs of about 16."), std::string::npos)
            << plan.warnings()[0].text;
    }
}

TEST(Calibration, AGivenPolarityThatExplainsLittleIsAnsweredWithTheOtherOne) {
    const auto scene = testing::hard_disc_liquid(500, 500, 16, 0.70, 1);
    const Image frame = testing::tanh_frame(scene, 16, 1.2, 0.02, 2);
    CalibrationOptions options;
    options.polarity = PolarityChoice::bright;
    RunPlan plan;
    std::vector<SizeCandidate> weighed;
    calibrate(frame, options, {}, {}, 2, plan, {}, &weighed);
    EXPECT_EQ(weighed[choose_size(weighed).best.value()].polarity, Polarity::dark);
    for (std::size_t i = 1; i < weighed.size(); ++i) {
        EXPECT_FALSE(weighed[i].polarity == weighed[0].polarity &&
                     weighed[i].diameter == weighed[0].diameter)
            << "named once";
    }
    ASSERT_FALSE(plan.warnings().empty());
    EXPECT_NE(plan.warnings()[0].text.find("calibrate.polarity dark"), std::string::npos)
        << plan.warnings()[0].text;
}

TEST(Calibration, AGivenSizeThatExplainsEnoughIsNotQuestioned) {
    const auto scene = testing::hard_disc_liquid(300, 300, 14, 0.5, 3);
    CalibrationOptions options;
    options.diameter = 13.8;
    RunPlan plan;
    std::vector<SizeCandidate> weighed;
    ASSERT_TRUE(calibrate(testing::tanh_frame(scene, 14, 1.2, 0.02, 2), options, {}, {}, 2, plan,
                          {}, &weighed));
    for (const SizeCandidate& candidate : weighed) EXPECT_EQ(candidate.diameter, 13.8);
    EXPECT_TRUE(plan.warnings().empty());
}

TEST(Calibration, ABlackSaturatedOrNoisyFrameHoldsNothing) {
    RunPlan plan;
    EXPECT_FALSE(calibrated(Image(200, 200, 0.0F), plan));
    EXPECT_FALSE(calibrated(Image(200, 200, 255.0F), plan));
    Image noise(200, 200);
    RandomStream random(5, "noise");
    for (float& v : noise.pixels()) v = static_cast<float>(100 + 10 * random.normal());
    EXPECT_FALSE(calibrated(noise, plan));
    EXPECT_EQ(plan.warnings().size(), 3u);
}

}  // namespace
}  // namespace grainfield::tracking
