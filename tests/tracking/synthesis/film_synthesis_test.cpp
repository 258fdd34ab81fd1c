#include "tracking/synthesis/film_synthesis.h"

#include <cmath>
#include <optional>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/memory_frames.h"
#include "tests/support/collect.h"
#include "tests/tracking/synthesis/rendered_layer.h"
#include "tracking/tracking.h"

namespace grainfield::tracking {
namespace {

using ::testing::HasSubstr;
using testing::rendered_layer;
using testing::RenderedLayer;

constexpr double kScale = 12;  // a [px]
constexpr double kNoise = 0.01;

Image counts_of(const RenderedLayer& layer) {
    Image counts = layer.brightness;
    for (float& v : counts.pixels()) v = 20 + 200 * v;
    return counts;
}

/// The layer as a whole moves by .04 a from frame to frame.
std::vector<Image> film(int frames) {
    RenderedLayer layer = rendered_layer(9, kScale, 0, 41);
    MirrorImage image(layer.brightness.width(), layer.brightness.height(), kScale, 2);
    std::vector<Image> counts;
    for (int f = 0; f < frames; ++f) {
        for (Point3& p : layer.spheres) p.x += 0.04F;
        image.render(MirrorScene(layer.spheres, layer.optics));
        layer.brightness = image.image();
        RandomStream random(42, "film", static_cast<std::uint64_t>(f));
        for (float& v : layer.brightness.pixels())
            v += static_cast<float>(kNoise * random.normal());
        counts.push_back(counts_of(layer));
    }
    return counts;
}

TrackOptions options(int threads = 2) {
    TrackOptions options;
    options.sphere_diameter = kScale;
    options.synthesis = true;
    options.synthesis_options.searches = 0;
    options.calibration.diameter = 0.9 * kScale;
    options.calibration.edge_width = 0.12 * kScale;
    options.threads = threads;
    return options;
}

Trajectory tracked(const std::vector<Image>& images, const TrackOptions& with,
                   RunPlan* plan = nullptr) {
    MemoryFrames frames(images);
    return track(frames, with, {.plan = plan});
}

std::string refusal(const TrackOptions& with) {
    try {
        tracked({film(1)}, with);
    } catch (const OptionError& error) {
        return error.what();
    }
    return "none";
}

ImageModel lit_model() {
    ImageModel model;
    model.disc.diameter = 0.9 * kScale;
    model.disc.edge_width = 0.1 * kScale;
    model.background = BackgroundSurface(220);
    model.dark_level = 20;
    return model;
}

TEST(FilmSynthesis, ReportsWhatLiesWithinTheBorderInPixelsWithItsLayer) {
    const ImageModel model = lit_model();
    const FilmSynthesis synthesis(model, 10, 0, {.height = 1.8});
    SynthesisedFrame found;
    found.position = {{4, 50}, {50, 60}, {30, 70}, {90, 95.5}, {40, 40}};
    found.error = {{1, 1}, {0.1, 0.2}, {1, 1}, {1, 1}, {1, 1}};
    found.z = {0.1, 0.7, 0.1, 0.7, 0.5};
    found.z_error = {0.05, 0.02, 0.01, 0.05, 0.2};
    found.residual = {0.1, 0.02, 0.3, 0.4, 0.5};
    Snapshot s;
    s.box = {.origin = {-0.5, -0.5}, .length = {101, 101}};
    synthesis.report(found, 5, s);
    EXPECT_NO_THROW(require_consistent(s));
    EXPECT_EQ(s.position, (std::vector<Vec2>{{50, 60}, {30, 70}, {40, 40}}));
    // A sphere at the lowest place has its centre a/2 above the plate.
    EXPECT_THAT(s.z, ::testing::Pointwise(::testing::DoubleNear(1e-12), {12.0, 6.0, 10.0}));
    EXPECT_THAT(s.z_error, ::testing::Pointwise(::testing::DoubleNear(1e-12), {0.2, 0.1, 2.0}));
    EXPECT_EQ(s.position_error[0], (Vec2{0.1, 0.2}));
    EXPECT_EQ(s.quality, (std::vector<double>{0.02, 0.3, 0.5}));
    EXPECT_EQ(s.layer, (std::vector<Layer>{Layer::top, Layer::bottom, Layer::unknown}));
    EXPECT_DOUBLE_EQ(synthesis.cell_height(), 18);
}

TEST(FilmSynthesis, TheFirstFrameEstimatesOpticsAndThoseAfterItKeepThem) {
    const RenderedLayer layer = rendered_layer(8, kScale, kNoise, 43);
    const Image counts = counts_of(layer);
    std::vector<Vec2> discs;
    for (const Point3& p : layer.spheres) {
        discs.push_back({static_cast<double>(p.x) * kScale, static_cast<double>(p.y) * kScale});
    }
    const ImageModel model = lit_model();
    const FilmSynthesis synthesis(model, kScale, 0, {.height = layer.height, .searches = 0});
    const SynthesisedFrame first = synthesis.next(counts, discs, nullptr, 2);
    EXPECT_NEAR(first.optics.blur, layer.optics.blur, 0.01);
    EXPECT_LT(first.residual_rms, 0.7 * first.residual_before);
    const SynthesisedFrame second = synthesis.next(counts, discs, &first, 2);
    EXPECT_EQ(second.optics.blur, first.optics.blur);
    EXPECT_EQ(second.optics.reflectivity, first.optics.reflectivity);
    EXPECT_EQ(second.error_scale, first.error_scale);
    // It starts at heights that are known. The start is rendered with fewer rays.
    EXPECT_LT(second.residual_before, 0.8 * first.residual_before);
    EXPECT_LT(second.residual_rms, 1.05 * first.residual_rms);
    // A frame without discs passes them on.
    const SynthesisedFrame blank = synthesis.next(counts, {}, &second, 2);
    EXPECT_TRUE(blank.position.empty());
    EXPECT_EQ(synthesis.next(counts, discs, &blank, 2).optics.blur, first.optics.blur);
}

TEST(FilmSynthesis, AFilmHasHeightsInEveryFrameWhateverTheThreads) {
    const std::vector<Image> images = film(3);
    RunPlan plan;
    const Trajectory one = tracked(images, options(1), &plan);
    const Trajectory three = tracked(images, options(3));
    ASSERT_EQ(one.snapshots.size(), 3U);
    for (std::size_t f = 0; f < 3; ++f) {
        const Snapshot& s = one.snapshots[f];
        EXPECT_GT(s.size(), 25U);
        EXPECT_EQ(s.z.size(), s.size());
        EXPECT_EQ(s.id.size(), s.size());
        EXPECT_DOUBLE_EQ(s.box.height, 1.94 * kScale);
        EXPECT_EQ(s.position, three.snapshots[f].position);
        EXPECT_EQ(s.z, three.snapshots[f].z);
        EXPECT_EQ(s.z_error, three.snapshots[f].z_error);
        EXPECT_EQ(s.id, three.snapshots[f].id);
    }
    EXPECT_THAT(plan.text(), HasSubstr("synthesis"));
}

TEST(FilmSynthesis, OpticsThatAreKeptSpareTheirEstimateAndOthersAreSaid) {
    const std::vector<Image> images = film(2);
    MemoryFrames first({images[0]});
    RunPlan first_plan;
    Tracker one(first, options(), first_plan);
    testing::Collect sink;
    Progress progress("", 0, "", Verbosity::quiet);
    const SynthesisSummary before = one.run(sink, progress).synthesis;
    EXPECT_GT(before.optics_error.blur, 0);
    KeptCalibration kept = one.to_keep();
    // Without factors of errors, which take more spheres, optics are not kept.
    EXPECT_EQ(kept.optics.has_value(), before.unscaled_frames == 0);
    kept.optics = FilmOptics{.diameter = kScale,
                             .height = 1.94,
                             .optics = before.optics,
                             .error = before.optics_error,
                             .error_scale = {{1, 1}, {1.5, 1.5}, 99}};

    TrackOptions again = options();
    again.calibration = {};
    again.kept = kept;
    RunPlan plan;
    MemoryFrames second({images[1]});
    Tracker other(second, again, plan);
    const TrackSummary summary = other.run(sink, progress);
    EXPECT_EQ(summary.synthesis.optics.blur, kept.optics->optics.blur);
    EXPECT_EQ(summary.synthesis.optics_error, kept.optics->error);
    EXPECT_EQ(summary.synthesis.unscaled_frames, 0);
    EXPECT_EQ(other.to_keep().optics, kept.optics);
    EXPECT_THAT(plan.text(), HasSubstr("as kept with the calibration"));

    again.layers.height = 1.8;
    RunPlan higher;
    MemoryFrames third({images[1]});
    const Tracker elsewhere(third, again, higher);
    EXPECT_THAT(higher.warnings().at(0).text, HasSubstr("layers.height is 1.94 there and 1.8"));
}

TEST(FilmSynthesis, ASlowFrameIsSavedAtItsEndWhetherDueOrNot) {
    const std::vector<Image> images = film(3);
    MemoryFrames frames(images);
    RunPlan plan;
    Tracker tracker(frames, options(), plan);
    int saved = 0;
    TrackResumption resumption{
        .is_due = [] { return false; }, .save = [&](Checkpoint&&) { ++saved; }, .slow = 0};
    testing::Collect sink;
    Progress progress("", 0, "", Verbosity::quiet);
    tracker.run(sink, progress, {}, resumption);
    // The first frame alone, then two at a time; nothing is saved after the last one.
    EXPECT_EQ(saved, 1);
    resumption.slow = 1e12;
    tracker.run(sink, progress, {}, resumption);
    EXPECT_EQ(saved, 1);
}

TEST(FilmSynthesis, WarnsWhereMostHeightsAreUnknownAndGivesSuchSpheresNoLayer) {
    SynthesisedFrame found;
    found.position = {{50, 60}, {30, 70}, {40, 40}};
    found.error = {{1, 1}, {1, 1}, {1, 1}};
    found.z = {0.8, 0.8, 0.05};
    found.z_error = {0.27, 0.21, 0.19};
    found.residual = {0.1, 0.1, 0.1};
    found.residual_before = 0.05;
    found.residual_rms = 0.02;
    found.error_scale.spheres = 160;
    SynthesisSummary summary;
    add(found, 0, summary);
    EXPECT_EQ(summary.heights_known, 1);
    RunPlan plan;
    warn_of(summary, plan);
    ASSERT_EQ(plan.warnings().size(), 1U);
    EXPECT_THAT(plan.warnings()[0].text, HasSubstr("only 1 of 3 heights are known"));
    const ImageModel model = lit_model();
    Snapshot s;
    s.box = {.origin = {-0.5, -0.5}, .length = {101, 101}};
    FilmSynthesis(model, 10, 0, {.height = 1.8}).report(found, 5, s);
    EXPECT_EQ(s.layer, (std::vector<Layer>{Layer::unknown, Layer::unknown, Layer::bottom}));
}

TEST(FilmSynthesis, TheHeightOfTheCellIsThatOfTheLayersWhereItIsGiven) {
    TrackOptions lower = options();
    lower.layers.height = 1.7;
    const Trajectory found = tracked(film(1), lower);
    EXPECT_DOUBLE_EQ(found.snapshots.at(0).box.height, 1.7 * kScale);
    for (const double z : found.snapshots[0].z) {
        EXPECT_GE(z, 0.5 * kScale - 1e-6);
        EXPECT_LE(z, 1.2 * kScale + 1e-6);
    }
}

TEST(FilmSynthesis, SaysWhatItNeeds) {
    TrackOptions unknown = options();
    unknown.sphere_diameter.reset();
    EXPECT_THAT(refusal(unknown), HasSubstr("give track.sphere-diameter"));
    TrackOptions masked = options();
    Image mask(84, 84, 1);
    mask(3, 3) = 0;
    masked.visible = VisiblePixels(mask);
    EXPECT_THAT(refusal(masked), HasSubstr("mask"));
    ImageModel bright = lit_model();
    bright.polarity = Polarity::bright;
    EXPECT_THROW(FilmSynthesis(bright, kScale, 0, {}), OptionError);
}

TEST(FilmSynthesis, WarnsOfDoubtfulSpheresAndOfAResidualThatDidNotFall) {
    SynthesisedFrame good;
    good.position.resize(200);
    good.z_error.assign(200, 0.1);
    good.residual_before = 0.05;
    good.residual_rms = 0.02;
    good.doubtful = 2;
    good.error_scale.spheres = 160;
    SynthesisSummary summary;
    add(good, 3, summary);
    RunPlan quiet;
    warn_of(summary, quiet);
    EXPECT_TRUE(quiet.warnings().empty());

    SynthesisedFrame bad = good;
    bad.doubtful = 20;
    bad.residual_rms = 0.06;
    bad.unexplained = 0.045;
    add(bad, 4, summary);
    add({}, 5, summary);  // nothing was found there
    EXPECT_EQ(summary.frames, 2);
    EXPECT_DOUBLE_EQ(summary.mean_before(), 0.05);
    EXPECT_DOUBLE_EQ(summary.mean_after(), 0.04);
    RunPlan plan;
    warn_of(summary, plan);
    ASSERT_EQ(plan.warnings().size(), 3U);
    EXPECT_EQ(plan.warnings()[2].code, WarningCode::doubtful_heights);
    EXPECT_THAT(plan.warnings()[2].text, HasSubstr("white noise apart (4.5 % at most)"));
    EXPECT_EQ(plan.warnings()[0].code, WarningCode::doubtful_heights);
    EXPECT_THAT(plan.warnings()[0].text, HasSubstr("in 1 of 2 frames"));
    EXPECT_THAT(plan.warnings()[0].text, HasSubstr("worst frame 4: 10.0 %"));
    EXPECT_EQ(plan.warnings()[1].code, WarningCode::doubtful_heights);
    EXPECT_THAT(plan.warnings()[1].text, HasSubstr("did not converge in 1 of 2"));
}

TEST(FilmSynthesis, WarnsOfErrorsThatCouldNotBeLearned) {
    SynthesisedFrame found;
    found.position.resize(20);
    found.z_error.assign(20, 0.1);
    found.residual_before = 0.05;
    found.residual_rms = 0.02;
    SynthesisSummary summary;
    add(found, 0, summary);
    found.error_scale.spheres = 40;
    add(found, 1, summary);
    RunPlan plan;
    warn_of(summary, plan);
    ASSERT_EQ(plan.warnings().size(), 1U);
    EXPECT_EQ(plan.warnings()[0].code, WarningCode::unscaled_errors);
    EXPECT_THAT(plan.warnings()[0].text, HasSubstr("errors in 1 of 2 frames"));
    EXPECT_THAT(plan.warnings()[0].text, HasSubstr("fewer than 30 spheres"));
}

}  // namespace
}  // namespace grainfield::tracking
