#include "tracking/synthesis/bias_learning.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "io/frame_files.h"
#include "io/frame_region.h"
#include "tests/support/csv_rows.h"
#include "tests/support/position_score.h"
#include "tests/tracking/synthesis/rendered_layer.h"
#include "tracking/synthesis/corrected_positions.h"
#include "tracking/tracking.h"

namespace grainfield::tracking {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

constexpr double kScale = 12;  // a [px]

ImageModel model_of_discs() {
    ImageModel model;
    model.disc = {0.89 * kScale, 0.13 * kScale};
    model.background = BackgroundSurface(1.0);
    model.dark_level = 0;
    model.noise = 0.01;
    model.residual_rms = 0.05;
    return model;
}

BiasSetting setting() {
    return {.diameter = kScale, .part = 16, .frames = 4, .seed = 1};
}

/// RMS distance per axis from the nearest true place, 2 a or more within [a].
double error_of(const Located& found, const testing::RenderedLayer& layer) {
    double squares = 0;
    double values = 0;
    for (const Vec2 p : found.position) {
        double least = 0.2 * 0.2;
        for (const Point3& q : layer.spheres) {
            if (!layer.is_inner(q, 2)) continue;
            least =
                std::min(least, squared_norm((1 / kScale) * p - Vec2{static_cast<double>(q.x),
                                                                     static_cast<double>(q.y)}));
        }
        if (least >= 0.2 * 0.2) continue;
        squares += least;
        values += 2;
    }
    return std::sqrt(squares / values);
}

// The model was not calibrated on the frame. What is learned on renderings fits it ill, although
// frames left out gain by two thirds.
TEST(BiasLearning, IsRefusedWhereTheImageShowsThatPositionsWouldGetWorseForAnyNumberOfThreads) {
    const auto layer = testing::rendered_layer(18, kScale, 0.01, 7);
    const ImageModel model = model_of_discs();
    const BiasLearning one = learn_bias(layer.brightness, model, setting(), 1);
    EXPECT_LT(one.correction.after, 0.9 * one.correction.before);
    EXPECT_LT(one.mirror_misfit, 0.6 * one.disc_misfit);
    EXPECT_THAT(one.refused, HasSubstr("does not suit the image"));
    const BiasLearning two = learn_bias(layer.brightness, model, setting(), 2);
    EXPECT_EQ(one.correction, two.correction);
    EXPECT_EQ(one.refused, two.refused);
    EXPECT_EQ(one.parts, 1);
    EXPECT_EQ(one.frames, 4);

    Locator locator(layer.brightness.width(), layer.brightness.height(), model, 2);
    locator.expect_misfit(model.residual_rms);
    const Image darkness = model.darkness(layer.brightness);
    const Located found = locator.locate(darkness, {}, {});
    Located corrected = found;
    correct_bias(one.correction, darkness, locator.residual(), kScale, corrected, 2);
    std::printf("held out: %.4f a before, %.4f after; the frame %.4f, %.4f\n",
                one.correction.before, one.correction.after, error_of(found, layer),
                error_of(corrected, layer));
    EXPECT_GT(error_of(corrected, layer), error_of(found, layer));
}

TEST(BiasLearning, IsRefusedWhereSpheresAreNoMirrors) {
    // Discs are explained by discs.
    const auto layer = testing::rendered_layer(14, kScale, 0.01, 7);
    const ImageModel model = model_of_discs();
    Image counts(layer.brightness.width(), layer.brightness.height(), 1.0F);
    for (const Point3& p : layer.spheres) {
        for (int y = 0; y < counts.height(); ++y) {
            for (int x = 0; x < counts.width(); ++x) {
                const double r = std::hypot(x - static_cast<double>(p.x) * kScale,
                                            y - static_cast<double>(p.y) * kScale);
                if (r > 2 * kScale) continue;
                counts(x, y) *= static_cast<float>(1 - model.disc.darkness(r));
            }
        }
    }
    RandomStream random(8, "camera");
    for (float& v : counts.pixels()) v += static_cast<float>(model.noise * random.normal());
    const BiasLearning learned = learn_bias(counts, model, setting(), 2);
    EXPECT_THAT(learned.refused, HasSubstr("mirror spheres leave"));
}

TEST(BiasLearning, IsRefusedWithoutSpheres) {
    Image empty(192, 192, 1.0F);
    RandomStream random(4, "noise");
    for (float& v : empty.pixels()) v += static_cast<float>(0.01 * random.normal());
    EXPECT_NE(learn_bias(empty, model_of_discs(), setting(), 2).refused, "");
}

/// Of spheres 2 a or more within, per axis [a]; and share of errors below two standard errors.
struct Judged {
    double rms = 0, median = 0, within = 0;
};

/// A square of a frame whose truth is known, tracked.
Judged judged(const fs::path& image, const fs::path& table, double a, const io::FrameRegion& region,
              bool corrected) {
    std::vector<Vec2> truth;
    for (auto& row : testing::csv_rows(table.string())) {
        truth.push_back({std::stod(row["x"]) - region.x, std::stod(row["y"]) - region.y});
    }
    auto frames = io::crop_frames(io::open_frames({image}, {}), region);
    TrackOptions options;
    options.sphere_diameter = a;
    options.correct_bias = corrected;
    options.threads = 2;
    const Snapshot found = track(*frames, options).snapshots.at(0);
    const auto score = testing::score_positions(found.position, truth, 0.25 * a, region.width,
                                                region.height, 2 * a);
    std::vector<double> errors;
    int within = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        const Vec2 p = truth[i];
        const bool is_inner =
            std::min({p.x, p.y, region.width - 1 - p.x, region.height - 1 - p.y}) >= 2 * a;
        if (score.partner[i] < 0 || !is_inner) continue;
        const auto j = static_cast<std::size_t>(score.partner[i]);
        const Vec2 off = found.position[j] - p;
        within += std::abs(off.x) < 2 * found.position_error[j].x;
        within += std::abs(off.y) < 2 * found.position_error[j].y;
        errors.insert(errors.end(), {std::abs(off.x) / a, std::abs(off.y) / a});
    }
    std::ranges::sort(errors);
    const Judged result{score.rms / a, errors.at(errors.size() / 2),
                        static_cast<double>(within) / static_cast<double>(errors.size())};
    std::printf("%s: %zu values, %.4f a RMS, median %.4f, %.3f within 2 standard errors\n",
                corrected ? "corrected" : "discs", errors.size(), result.rms, result.median,
                result.within);
    return result;
}

// The image has another ray tracer's optics: a panel that is brighter at grazing angles.
TEST(BiasLearning, TakesAQuarterOffTheErrorOnAFrameOfAnotherRayTracer) {
    const fs::path folder = fs::path(GRAINFIELD_SOURCE_DIR) / "data-samples";
    const io::FrameRegion region{120, 120, 160, 160};
    const auto judge = [&](bool corrected) {
        return judged(folder / "traced-layer.png", folder / "traced-layer-true.csv", 10.09, region,
                      corrected);
    };
    const Judged discs = judge(false);
    const Judged corrected = judge(true);
    EXPECT_LT(corrected.rms, 0.75 * discs.rms);
    EXPECT_LT(corrected.median, 0.75 * discs.median);
}

TEST(BiasLearning, TakesAThirdOffTheErrorBeforeAFarPanelWithErrorsThatHold) {
    const fs::path folder = fs::path(GRAINFIELD_SOURCE_DIR) / "../shared/data/traced";
    if (!fs::exists(folder / "far_panel.png")) GTEST_SKIP() << "no " << folder;
    const io::FrameRegion region{296, 296, 224, 224};
    const auto judge = [&](bool corrected) {
        return judged(folder / "far_panel.png", folder / "far_panel_true.csv", 16, region,
                      corrected);
    };
    const Judged discs = judge(false);
    const Judged corrected = judge(true);
    EXPECT_LT(corrected.rms, 0.67 * discs.rms);
    EXPECT_GT(corrected.within, 0.92);
    EXPECT_LT(corrected.within, 0.98);
}

}  // namespace
}  // namespace grainfield::tracking
