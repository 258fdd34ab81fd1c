#include "tracking/film_bias.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

#include "core/errors.h"
#include "core/support/random.h"
#include "tests/tracking/synthesis/rendered_layer.h"
#include "tracking/calibrate/calibration.h"
#include "tracking/film_model.h"
#include "tracking/model/padded_image.h"
#include "tracking/refine/disc_kernel.h"
#include "tracking/synthesis/general_correction.h"
#include "tracking/synthesis/mirror_image.h"

namespace grainfield::tracking {
namespace {

using ::testing::HasSubstr;

constexpr double kScale = 12;  // a [px]

/// One frame, again and again.
class SameFrames : public FrameSource {
 public:
    SameFrames(Image image, std::int64_t count) : image_(std::move(image)), count_(count) {}

    std::int64_t count() const override { return count_; }
    int width() const override { return image_.width(); }
    int height() const override { return image_.height(); }
    int bit_depth() const override { return 8; }
    std::optional<double> frame_rate() const override { return std::nullopt; }
    Frame read(std::int64_t index) override {
        ++reads_;
        Frame frame;
        frame.index = index;
        frame.image = image_;
        return frame;
    }
    std::string name() const override { return "the same frame"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }
    int reads() const { return reads_; }

 private:
    Image image_;
    std::int64_t count_;
    int reads_ = 0;
    std::vector<std::string> warnings_;
};

/// Mirror spheres before a panel, with the noise of a camera.
const Image& mirrors() {
    static const Image frame = [] {
        const testing::RenderedLayer layer = testing::rendered_layer(14, kScale, 0, 7);
        const int side = layer.brightness.width();
        MirrorImage image(side, side, kScale, 2);
        image.render_only(MirrorScene(layer.spheres, layer.optics));
        Image counts = image.image();
        RandomStream random(1, "camera");
        for (float& v : counts.pixels()) v = 200 * v + static_cast<float>(2 * random.normal());
        return counts;
    }();
    return frame;
}

/// The same spheres as opaque discs.
Image silhouettes() {
    const testing::RenderedLayer layer = testing::rendered_layer(14, kScale, 0, 7);
    const int side = layer.brightness.width();
    const DiscProfile disc{0.89 * kScale, 0.13 * kScale};
    std::vector<Vec2> places;
    for (const Point3& p : layer.spheres) {
        places.push_back({kScale * static_cast<double>(p.x), kScale * static_cast<double>(p.y)});
    }
    PaddedImage transmission = clear_transmission(side, side, disc);
    place_discs(transmission, places, disc);
    RandomStream random(1, "camera");
    Image counts(side, side);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            counts(x, y) = 200 * transmission.row(y)[x] + static_cast<float>(2 * random.normal());
        }
    }
    return counts;
}

/// As discs with a dark core and a bright rim, blurred, higher ones before lower ones.
Image rimmed(double scale, double rim) {
    const testing::RenderedLayer layer = testing::rendered_layer(24, scale, 0, 7);
    const int side = layer.brightness.width();
    std::vector<Point3> upwards = layer.spheres;
    std::sort(upwards.begin(), upwards.end(),
              [](const Point3& a, const Point3& b) { return a.z < b.z; });
    cv::Mat1f seen(side, side, 1.0F);
    constexpr int kShift = 8;  // of the points of cv::circle: 1/256 px
    const auto paint = [&](const Point3& p, double radius, double brightness) {
        const auto fixed = [](double v) {
            return static_cast<int>(std::lround(v * (1 << kShift)));
        };
        cv::circle(
            seen,
            {fixed(scale * static_cast<double>(p.x)), fixed(scale * static_cast<double>(p.y))},
            fixed(radius * scale), brightness, cv::FILLED, cv::LINE_8, kShift);
    };
    for (const Point3& p : upwards) {
        paint(p, 0.44, rim);
        paint(p, 0.34, 0);
    }
    cv::GaussianBlur(seen, seen, {0, 0}, 0.1 * scale);
    RandomStream random(1, "camera");
    Image counts(side, side);
    for (int y = 0; y < side; ++y) {
        for (int x = 0; x < side; ++x) {
            counts(x, y) = 200 * seen(y, x) + static_cast<float>(2 * random.normal());
        }
    }
    return counts;
}

ImageModel model() {
    ImageModel model;
    model.disc = {0.89 * kScale, 0.13 * kScale};
    model.background = BackgroundSurface(200.0);
    model.dark_level = 0;
    model.noise = 0.01;
    model.residual_rms = 0.05;
    return model;
}

TrackOptions options() {
    TrackOptions options;
    options.sphere_diameter = kScale;
    options.threads = 2;
    return options;
}

/// Why no correction is used; fails where one is, or where a frame is read to see that.
std::string skipped(const TrackOptions& options, const ImageModel& discs = model()) {
    SameFrames source(mirrors(), 3);
    RunPlan plan;
    const FilmBias found = bias_of_film(source, options, discs, 0, 2, plan);
    EXPECT_FALSE(found.correction.has_value());
    EXPECT_EQ(found.decision.source, BiasSource::none);
    EXPECT_TRUE(plan.warnings().empty()) << "nobody asked for it";
    EXPECT_EQ(source.reads(), 0);
    for (const PlannedStage& stage : plan.skipped()) {
        if (stage.stage != "bias") continue;
        EXPECT_EQ(found.decision.reason, stage.reason);
        return stage.reason;
    }
    return "";
}

TEST(FilmBias, OfMirrorsIsTheGeneralOneWithoutBeingAskedFor) {
    SameFrames source(mirrors(), 1);
    RunPlan plan;
    const FilmBias found = bias_of_film(source, options(), model(), 0, 2, plan);
    const std::optional<BiasCorrection>& bias = found.correction;
    ASSERT_TRUE(bias.has_value());
    EXPECT_TRUE(bias->is_general());
    EXPECT_EQ(*bias, general_correction().of(model().disc, kScale));
    EXPECT_EQ(found.decision.source, BiasSource::general);
    EXPECT_EQ(found.decision.cameras, general_correction().cameras);
    EXPECT_GT(found.decision.moved.value_or(0), 0);
    EXPECT_EQ(found.decision.after, general_correction().after);
    ASSERT_EQ(plan.stages().size(), 1U);
    EXPECT_THAT(plan.stages()[0].reason, HasSubstr("other cameras"));
}

TEST(FilmBias, OfMirrorsIsWhatSynthesisBeginsWithWhateverACalibrationKept) {
    TrackOptions synthesis = options();
    synthesis.synthesis = true;
    for (const bool is_kept : {false, true}) {
        if (is_kept) synthesis.kept.emplace().bias.emplace();
        SameFrames source(mirrors(), 1);
        RunPlan plan;
        const auto bias = bias_of_film(source, synthesis, model(), 0, 2, plan).correction;
        ASSERT_TRUE(bias.has_value());
        EXPECT_TRUE(bias->is_general());
        EXPECT_THAT(plan.stages()[0].reason, HasSubstr("positions that synthesis begins with"));
    }
}

// Fewer than the 500 spheres that learning needs are in the frame.
TEST(FilmBias, IsTheGeneralOneWithAWarningWhereLearningIsRefused) {
    const int side = static_cast<int>(11 * kScale);
    Image small(side, side);
    for (int y = 0; y < side; ++y) std::copy_n(mirrors().row(y + 12) + 12, side, small.row(y));
    SameFrames source(small, 1);
    RunPlan plan;
    TrackOptions asked = options();
    asked.correct_bias = true;
    const auto bias = bias_of_film(source, asked, model(), 0, 2, plan).correction;
    ASSERT_EQ(plan.warnings().size(), 1U);
    ASSERT_TRUE(bias.has_value());
    EXPECT_TRUE(bias->is_general());
}

TEST(FilmBias, IsLearnedFromTheFilmWhereThatIsAskedFor) {
    SameFrames source(mirrors(), 1);
    RunPlan plan;
    TrackOptions asked = options();
    asked.correct_bias = true;
    const auto bias = bias_of_film(source, asked, model(), 0, 2, plan).correction;
    ASSERT_TRUE(bias.has_value());
    EXPECT_FALSE(bias->is_general());
    EXPECT_LT(bias->after, 0.9 * bias->before);
    EXPECT_EQ(bias->diameter, kScale);
}

TEST(FilmBias, SaysWhyItIsLeftOutWhereItCannotHelp) {
    TrackOptions no = options();
    no.correct_bias = false;
    EXPECT_THAT(skipped(no), HasSubstr("not wanted"));
    TrackOptions unknown = options();
    unknown.sphere_diameter.reset();
    EXPECT_THAT(skipped(unknown), HasSubstr("diameter is not known"));
    TrackOptions masked = options();
    Image mask(mirrors().width(), mirrors().height(), 1.0F);
    mask(3, 3) = 0;
    masked.visible = VisiblePixels(mask);
    EXPECT_THAT(skipped(masked), HasSubstr("a mask hides a part"));
    TrackOptions tilted = options();
    Camera camera;
    camera.width = mirrors().width();
    camera.height = mirrors().height();
    tilted.camera.emplace(camera, Vec2{0, 0});
    EXPECT_THAT(skipped(tilted), HasSubstr("a straight lens"));
    TrackOptions wrong_size = options();
    wrong_size.sphere_diameter = 5 * kScale;
    EXPECT_THAT(skipped(wrong_size), HasSubstr("no usual picture"));
    ImageModel good = model();
    good.residual_rms = 1.1 * good.noise;
    EXPECT_THAT(skipped(options(), good), HasSubstr("discs explain the film"));
    ImageModel bright = model();
    bright.polarity = Polarity::bright;
    EXPECT_THAT(skipped(options(), bright), HasSubstr("bright spheres"));
    ImageModel blurred = model();
    blurred.disc.edge_width = 0.3 * kScale;
    EXPECT_THAT(skipped(options(), blurred), HasSubstr("edges are 0.300 a wide"));
}

TEST(FilmBias, KeptWithACalibrationIsLeftOutWhereNoneIsWanted) {
    TrackOptions kept = options();
    kept.kept.emplace().bias.emplace();
    kept.kept->bias->diameter = kScale;
    kept.kept->bias->height = kept.synthesis_options.height;
    SameFrames source(mirrors(), 3);
    RunPlan plan;
    EXPECT_TRUE(bias_of_film(source, kept, model(), 0, 2, plan).correction.has_value());
    kept.correct_bias = false;
    EXPECT_THAT(skipped(kept), HasSubstr("not wanted"));
    kept.sphere_diameter.reset();
    EXPECT_NO_THROW(require_consistent(kept));
}

TEST(FilmBias, KeptWithACalibrationIsLeftOutWithAWarningWhereTheDiameterIsNotGiven) {
    TrackOptions kept = options();
    kept.kept.emplace().bias.emplace();
    kept.kept->bias->diameter = kScale;
    kept.sphere_diameter.reset();
    SameFrames source(mirrors(), 3);
    RunPlan plan;
    const FilmBias found = bias_of_film(source, kept, model(), 0, 2, plan);
    EXPECT_FALSE(found.correction.has_value());
    EXPECT_EQ(found.decision.source, BiasSource::none);
    ASSERT_EQ(plan.warnings().size(), 1U);
    EXPECT_THAT(plan.warnings()[0].text, HasSubstr("track.sphere-diameter"));
}

TEST(FilmBias, OfATrackerWithAnotherPurposeIsPlannedAndCostsNothing) {
    for (const bool is_asked_for : {true, false}) {
        TrackOptions other = options();
        other.corrects_bias = false;
        if (is_asked_for) other.correct_bias = true;
        SameFrames source(mirrors(), 500);
        RunPlan plan;
        EXPECT_FALSE(bias_of_film(source, other, model(), 0, 2, plan).correction.has_value());
        EXPECT_EQ(source.reads(), 0);
        ASSERT_EQ(plan.stages().size(), 1U);
        EXPECT_THAT(plan.stages()[0].reason, HasSubstr("on the first usable frame"));
    }
}

// Discs that are modelled wrongly leave more than noise, and still mirror nothing.
TEST(FilmBias, OfSilhouettesIsLeftOutAndThatIsAWarningOnlyWhereOneWasAskedFor) {
    SameFrames source(silhouettes(), 500);
    RunPlan plan;
    EXPECT_FALSE(bias_of_film(source, options(), model(), 0, 2, plan).correction.has_value());
    ASSERT_EQ(plan.skipped().size(), 1U);
    EXPECT_THAT(plan.skipped()[0].reason, HasSubstr("no mirrors above a panel"));
    EXPECT_TRUE(plan.warnings().empty());
    TrackOptions asked = options();
    asked.correct_bias = true;
    EXPECT_FALSE(bias_of_film(source, asked, model(), 0, 2, plan).correction.has_value());
    EXPECT_EQ(plan.warnings().size(), 1U);
}

// Of a size and with a misfit that mirrors may have: the pattern of what discs leave tells them.
TEST(FilmBias, OfDiscsWithARimIsLeftOutByPixelsAndByBlocks) {
    int only_by_pattern = 0;
    for (const double scale : {10.0, 18.0}) {
        for (const double rim : {0.35, 0.45}) {
            const Image frame = rimmed(scale, rim);
            TrackOptions rims = options();
            rims.sphere_diameter = scale;
            rims.detection = detection_of(rims);
            CalibrationOptions calibration;
            calibration.binning.factor = mirror_blocks(scale);
            RunPlan plan;
            const auto calibrated = calibrate(frame, calibration, rims.detection, {}, 2, plan);
            ASSERT_TRUE(calibrated.has_value());
            const CorrectionJudgement judgement =
                judge_correction(general_correction(), frame, calibrated->model.in_pixels(),
                                 rims.detection, {}, scale, 2);
            EXPECT_LT(judgement.log_odds, CorrectionJudgement::kLeastOdds) << scale << ' ' << rim;
            only_by_pattern += judgement.is_too_large() ? 0 : 1;
            SameFrames source(frame, 1);
            const FilmBias found = bias_of_film(source, rims, calibrated->model, 0, 2, plan);
            EXPECT_FALSE(found.correction.has_value()) << scale << ' ' << rim;
            EXPECT_THAT(found.decision.reason, HasSubstr("no mirrors above a panel"));
        }
    }
    EXPECT_GE(only_by_pattern, 2);
}

TEST(FilmBias, OfTooFewSpheresToJudgeItIsLeftOut) {
    const int side = static_cast<int>(6 * kScale);  // two spheres across within the border
    Image small(side, side);
    for (int y = 0; y < side; ++y) {
        std::copy_n(mirrors().row(y + side / 2) + side / 2, side, small.row(y));
    }
    SameFrames source(small, 1);
    RunPlan plan;
    EXPECT_FALSE(bias_of_film(source, options(), model(), 0, 2, plan).correction.has_value());
    ASSERT_EQ(plan.skipped().size(), 1U);
    EXPECT_THAT(plan.skipped()[0].reason, HasSubstr("do not show whether"));
}

}  // namespace
}  // namespace grainfield::tracking
