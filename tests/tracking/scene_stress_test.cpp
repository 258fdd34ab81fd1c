// Single frames that push the tracker to where it may break, each through the whole of tracking
// with no option. Expectations come from the joint Cramér–Rao bound of the same discs and noise: n
// spheres give the RMS error with a relative scatter of 1/√(4n). Measured:
// bench/results/tracking-stress.md.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/memory_frames.h"
#include "core/support/random.h"
#include "tests/support/collect.h"
#include "tests/support/layer_frames.h"
#include "tests/support/position_score.h"
#include "tracking/score/position_bounds.h"
#include "tracking/tracker.h"

namespace grainfield::tracking {
namespace {

using testing::Collect;
using testing::LayerScene;
using testing::PositionScore;
using testing::score_positions;

struct Tracked {
    std::vector<Snapshot> snapshots;
    std::vector<Warning> warnings;
    DiscProfile disc;
};

Tracked tracked(const std::vector<Image>& frames, const TrackOptions& options = {}) {
    MemoryFrames source(frames);
    Collect sink;
    RunPlan plan;
    Tracker tracker(source, options, plan);
    Progress progress("tracking", source.count(), "frames", Verbosity::quiet);
    tracker.run(sink, progress);
    return {sink.snapshots, plan.warnings(),
            tracker.is_calibrated() ? tracker.model().disc : DiscProfile{}};
}

/// Discs of the tracker's own kind in light that may vary: I = dark + span(x) T + noise, rounded
/// and clipped to 8 bits.
template <class Span, class Noise>
Image lit_frame(const LayerScene& scene, double edge_width, double dark, Span&& span,
                Noise&& noise) {
    const Image ideal = testing::tanh_frame(scene, scene.diameter, edge_width, 0, 1);
    RandomStream random(1, "stress noise");
    Image counts(scene.width, scene.height);
    for (int y = 0; y < scene.height; ++y) {
        for (int x = 0; x < scene.width; ++x) {
            const double transmission = (static_cast<double>(ideal(x, y)) - 30) / 170;
            const double value = dark + span(x, y) * transmission + noise(x, y) * random.normal();
            counts(x, y) = static_cast<float>(std::clamp(std::round(value), 0.0, 255.0));
        }
    }
    return counts;
}

auto everywhere(double value) {
    return [value](int, int) { return value; };
}

/// RMS error over RMS bound, of the spheres matched; `noise` [contrast].
double over_bound(const PositionScore& score, const LayerScene& scene, double edge_width,
                  double noise) {
    const std::vector<Vec2> bounds = position_bounds(scene.position, {scene.diameter, edge_width},
                                                     scene.width, scene.height, noise, 2);
    double squares = 0;
    double n = 0;
    for (std::size_t i = 0; i < bounds.size(); ++i) {
        if (score.partner[i] < 0) continue;
        squares += squared_norm(bounds[i]) / 2;
        n += 1;
    }
    return score.rms / std::sqrt(squares / n);
}

/// All spheres farther than `margin` from the border are found, nothing else is, and errors are at
/// most `limit` times the bound.
void expect_all_found(const Tracked& result, const LayerScene& scene, double edge_width,
                      double noise, double margin, double limit) {
    const PositionScore score =
        score_positions(result.snapshots.at(0).position, scene.position, scene.diameter / 4,
                        scene.width, scene.height, margin);
    EXPECT_EQ(score.missed, 0);
    EXPECT_EQ(score.spurious, 0);
    EXPECT_LT(over_bound(score, scene, edge_width, noise), limit);
    ::testing::Test::RecordProperty("over_bound",
                                    std::to_string(over_bound(score, scene, edge_width, noise)));
    EXPECT_NEAR(result.disc.diameter, scene.diameter, 0.01 * scene.diameter);
    EXPECT_TRUE(result.warnings.empty()) << result.warnings[0].text;
}

constexpr double kRounding = 1.0 / 12;  // variance [counts²]
/// Of frames with 2 % noise and a contrast of 170 counts.
const double kNoise = std::sqrt(0.02 * 0.02 + kRounding / (170 * 170));

TEST(SceneStress, SpheresOfThreePixels) {
    // 784: 1.8 %; the disc is sampled at pixel centres, so that its information varies with phase.
    const auto dilute = testing::isolated_discs(200, 200, 3, 7, 1);
    expect_all_found(tracked({testing::tanh_frame(dilute, 3, 0.5, 0.02, 1)}), dilute, 0.5, kNoise,
                     3, 1.12);
    const auto dense = testing::hard_disc_liquid(200, 200, 3, 0.6, 1);
    expect_all_found(tracked({testing::tanh_frame(dense, 3, 0.5, 0.02, 1)}), dense, 0.5, kNoise, 3,
                     1.12);
}

TEST(SceneStress, SpheresOf200PixelsWithASharpEdge) {
    // 36 spheres, 8 %: three standard deviations.
    const auto scene = testing::hard_disc_liquid(1400, 1000, 200, 0.6, 1);
    expect_all_found(tracked({testing::tanh_frame(scene, 200, 4, 0.02, 1)}), scene, 4, kNoise, 60,
                     1.25);
}

TEST(SceneStress, AContrastOfThreePercent) {
    // 7.65 of 255 counts; noise 0.5 counts, rounding 0.29: together 7.6 % of the contrast. 3 % of
    // scatter.
    const auto scene = testing::hard_disc_liquid(320, 320, 16, 0.6, 1);
    const Image frame = lit_frame(scene, 1.2, 120, everywhere(7.65), everywhere(0.5));
    expect_all_found(tracked({frame}), scene, 1.2, std::sqrt(0.25 + kRounding) / 7.65, 16, 1.13);
}

TEST(SceneStress, LightThatFallsToAThirdAcrossTheFrame) {
    const auto scene = testing::hard_disc_liquid(400, 400, 16, 0.6, 1);
    const auto span = [](int x, int) { return 200 * (1 - 0.7 * x / 400); };
    const auto noise = [&](int x, int y) { return 0.02 * span(x, y); };
    expect_all_found(tracked({lit_frame(scene, 1.2, 20, span, noise)}), scene, 1.2, 0.0202, 16,
                     1.13);
}

TEST(SceneStress, ShadowOverHalfOfTheFrame) {
    // A step of the light is no polynomial: spheres at the shadow's edge are displaced, none is
    // lost.
    const auto scene = testing::hard_disc_liquid(400, 400, 16, 0.5, 1);
    const auto span = [](int x, int) { return x < 200 ? 70.0 : 170.0; };
    const Tracked result =
        tracked({lit_frame(scene, 1.2, 20, span, [&](int x, int y) { return 0.02 * span(x, y); })});
    const PositionScore score =
        score_positions(result.snapshots[0].position, scene.position, 4, 240, 240, 16);
    EXPECT_EQ(score.missed, 0);
    EXPECT_EQ(score.spurious, 0);
    EXPECT_LT(score.rms, 0.25);
}

TEST(SceneStress, HalfOfTheFrameWithoutAnyLightIsWarnedOfAndTheLitHalfAloneIsTracked) {
    // The dark half is one large black shape: no image model of discs holds there.
    const auto scene = testing::hard_disc_liquid(400, 400, 16, 0.5, 1);
    const auto span = [](int x, int) { return x < 200 ? 170.0 : 0.0; };
    const Image frame = lit_frame(scene, 1.2, 20, span, everywhere(3.4));
    const Tracked whole = tracked({frame});
    EXPECT_FALSE(whole.warnings.empty());
    Image lit(200, 400);
    for (int y = 0; y < 400; ++y) std::copy_n(frame.row(y), 200, lit.row(y));
    const Tracked half = tracked({lit});
    const PositionScore score =
        score_positions(half.snapshots[0].position, scene.position, 4, 200, 400, 40);
    EXPECT_EQ(score.missed, 0);
    EXPECT_EQ(score.spurious, 0);
    EXPECT_LT(over_bound(score, scene, 1.2, 0.0202), 1.15);
}

TEST(SceneStress, FortyThousandSpheres) {
    const auto scene = testing::hard_disc_liquid(1900, 1900, 9, 0.71, 1);
    ASSERT_GT(scene.position.size(), 40000U);
    // Size given: estimating it is what takes long on a frame like this.
    TrackOptions options;
    options.calibration.diameter = 9;
    options.calibration.edge_width = 0.9;
    const Tracked result = tracked({testing::tanh_frame(scene, 9, 0.9, 0.02, 1)}, options);
    expect_all_found(result, scene, 0.9, kNoise, 9, 1.05);
}

TEST(SceneStress, ASaturatedBackground) {
    // As on the real frame (78 % of its bright pixels are clipped), by a camera that knows nothing
    // of tanh. What is clipped makes discs smaller and edges sharper; it costs half the bound.
    testing::CrystalPatch patch;
    patch.radius = 0.25;
    const auto scene = testing::crystal_in_liquid(480, 480, 12, 0.68, patch, 2);
    testing::Camera camera;
    camera.exposure = 1.25;
    const Image frame = testing::camera_frame(scene, camera, 1);
    const auto clipped = std::count(frame.pixels().begin(), frame.pixels().end(), 255.0F);
    // 29 % of the frame is clear of spheres.
    EXPECT_GT(static_cast<double>(clipped), 0.78 * 0.29 * static_cast<double>(frame.size()));
    const Tracked result = tracked({frame});
    const PositionScore score =
        score_positions(result.snapshots[0].position, scene.position, 3, 480, 480, 12);
    EXPECT_LE(score.missed, 1);
    EXPECT_LE(score.spurious, 1);
    EXPECT_LT(score.rms, 0.05);
}

TEST(SceneStress, SpheresCutByTheBorder) {
    // Centres between D/4 and D from the border, along all four sides. 44: 7.5 %.
    LayerScene scene{400, 400, 20, {}, {}, 0};
    RandomStream random(1, "border");
    for (int i = 0; i < 12; ++i) {
        const double along = 25 + 30.5 * i;
        const double depth = random.uniform(5.5, 19);
        scene.position.push_back({along, depth});
        scene.position.push_back({along, 399 - depth});
        if (i == 0 || i == 11) continue;
        scene.position.push_back({depth, along});
        scene.position.push_back({399 - depth, along});
    }
    expect_all_found(tracked({testing::tanh_frame(scene, 20, 1.5, 0.02, 1)}), scene, 1.5, kNoise, 5,
                     1.25);
}

TEST(SceneStress, OneSphereAndNone) {
    LayerScene scene{400, 300, 16, {{133.3, 200.7}}, {}, 1};
    // One error: below four standard deviations.
    expect_all_found(tracked({testing::tanh_frame(scene, 16, 1.2, 0.02, 1)}), scene, 1.2, kNoise,
                     16, 4);
    scene.position.clear();
    const Tracked none = tracked({testing::tanh_frame(scene, 16, 1.2, 0.02, 1)});
    EXPECT_TRUE(none.snapshots[0].position.empty());
    EXPECT_FALSE(none.warnings.empty());
}

TEST(SceneStress, NoiseThatHidesTheSizeIsRefusedUnlessTheDiameterIsGiven) {
    const auto scene = testing::isolated_discs(192, 192, 16, 32, 1);
    const Image frame = lit_frame(scene, 1.2, 80, everywhere(90), everywhere(0.25 * 90));
    const Tracked blind = tracked({frame});
    ASSERT_FALSE(blind.warnings.empty());
    EXPECT_NE(blind.warnings[0].text.find("give calibrate.disc-diameter"), std::string::npos)
        << blind.warnings[0].text;
    for (const Snapshot& snapshot : blind.snapshots) EXPECT_EQ(snapshot.size(), 0U);
    TrackOptions options;
    options.calibration.diameter = 16;
    const Tracked told = tracked({frame}, options);
    const PositionScore score =
        score_positions(told.snapshots.at(0).position, scene.position, 4, 192, 192, 16);
    EXPECT_EQ(score.missed, 0);
    EXPECT_EQ(score.spurious, 0);
}

TEST(SceneStress, NoiseOfAFifthHidesNoSizeOfFewSpheres) {
    const auto scene = testing::isolated_discs(240, 240, 16, 60, 1);
    const Image frame = lit_frame(scene, 1.2, 80, everywhere(90), everywhere(0.2 * 90));
    const Tracked found = tracked({frame});
    const PositionScore score =
        score_positions(found.snapshots.at(0).position, scene.position, 4, 240, 240, 16);
    EXPECT_EQ(score.missed, 0);
    EXPECT_LE(score.spurious, 1);
}

TEST(SceneStress, PureNoiseHoldsNoSphere) {
    for (const double sigma : {0.6, 2.0, 10.0, 40.0}) {
        const Tracked result = tracked({testing::noise_frame(256, 256, 120, sigma, 0, 7)});
        EXPECT_TRUE(result.snapshots[0].position.empty()) << sigma;
        EXPECT_FALSE(result.warnings.empty()) << sigma;
    }
}

TEST(SceneStress, NoiseAfterAGoodFrameHoldsNoSphere) {
    // The spheres are gone, and so is their contrast: clear background at four noise levels, and a
    // texture with blobs of 15 % of the contrast.
    const auto scene = testing::hard_disc_liquid(256, 256, 16, 0.5, 1);
    std::vector<Image> frames{testing::tanh_frame(scene, 16, 1.2, 0.02, 1)};
    for (const double sigma : {1.0, 3.4, 17.0, 34.0}) {
        frames.push_back(testing::noise_frame(256, 256, 200, sigma, 0, 7));
    }
    frames.push_back(testing::noise_frame(256, 256, 200, 8, 4, 7));
    const Tracked result = tracked(frames);
    EXPECT_GT(result.snapshots[0].size(), 100U);
    for (std::size_t f = 1; f < frames.size(); ++f) {
        EXPECT_EQ(result.snapshots[f].size(), 0U) << "frame " << f;
    }
}

TEST(SceneStress, SixteenBitsWithAnOffset) {
    const auto scene = testing::hard_disc_liquid(320, 320, 16, 0.6, 1);
    const Image eight = testing::tanh_frame(scene, 16, 1.2, 0.02, 1);
    Image sixteen = eight;
    for (float& v : sixteen.pixels()) v = 9000 + 200 * v;
    const Snapshot a = tracked({eight}).snapshots[0];
    const Snapshot b = tracked({sixteen}).snapshots[0];
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        // The same image up to the rounding of single precision.
        EXPECT_LT(norm(a.position[i] - b.position[i]), 0.01) << i;
    }
}

}  // namespace
}  // namespace grainfield::tracking
