#include "tracking/film_model.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/memory_frames.h"
#include "core/support/random.h"
#include "tests/tracking/synthesis/rendered_layer.h"
#include "tracking/model/padded_image.h"
#include "tracking/refine/disc_kernel.h"
#include "tracking/synthesis/mirror_image.h"
#include "tracking/tracking.h"

namespace grainfield::tracking {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kScale = 17;        // a [px]
constexpr double kSide = 16;         // of the layer [a]
constexpr double kView = kSide - 2;  // of the frame [a]

const testing::RenderedLayer& layer() {
    static const testing::RenderedLayer layer = testing::rendered_layer(kSide, kScale, 0, 7);
    return layer;
}

Image with_noise(Image image) {
    RandomStream random(1, "camera");
    for (float& v : image.pixels()) v = 200 * v + static_cast<float>(2 * random.normal());
    return image;
}

/// Mirror spheres before a panel.
const Image& mirrors() {
    static const Image frame = [] {
        const int side = layer().brightness.width();
        MirrorImage image(side, side, kScale, 2);
        image.render_only(MirrorScene(layer().spheres, layer().optics));
        return with_noise(image.image());
    }();
    return frame;
}

/// The same spheres as the image model has them.
const Image& discs() {
    static const Image frame = [] {
        const int side = layer().brightness.width();
        const DiscProfile disc{0.89 * kScale, 0.1 * kScale};
        std::vector<Vec2> places;
        for (const Point3& p : layer().spheres) {
            places.push_back(
                {kScale * static_cast<double>(p.x), kScale * static_cast<double>(p.y)});
        }
        PaddedImage transmission = clear_transmission(side, side, disc);
        place_discs(transmission, places, disc);
        return with_noise(transmission.inner());
    }();
    return frame;
}

TrackOptions options(std::optional<int> binning = {}) {
    TrackOptions options;
    options.sphere_diameter = kScale;
    options.binning = binning;
    options.threads = 2;
    return options;
}

struct Seen {
    FilmModel model;
    RunPlan plan;

    int side() const { return model.film.calibration->model.binning.factor; }
    std::vector<std::string> skipped() const {
        std::vector<std::string> stages;
        for (const PlannedStage& stage : plan.skipped()) stages.push_back(stage.stage);
        return stages;
    }
};

Seen seen(const Image& image, TrackOptions given) {
    given.detection = detection_of(given);
    MemoryFrames frames({image}, {}, "frame");
    Seen seen;
    seen.model = model_of_film(frames, given, 2, seen.plan);
    EXPECT_TRUE(seen.model.film.calibration.has_value());
    return seen;
}

TEST(FilmModel, OfMirrorsIsOfBlocksWhereEightAreLeftToASphere) {
    const Seen mirror = seen(mirrors(), options());
    EXPECT_EQ(mirror.side(), 2);
    EXPECT_EQ(mirror.model.bias.decision.source, BiasSource::general);
    EXPECT_THAT(mirror.skipped(), Contains("single pixels"));
    EXPECT_THAT(mirror.model.binning_reason, HasSubstr("mirror images"));
}

TEST(FilmModel, TakesTheLargestBlocksThatLeaveEightToASphere) {
    EXPECT_EQ(mirror_blocks(15.9), 1);
    EXPECT_EQ(mirror_blocks(15.95), 2) << "nearly whole";
    EXPECT_EQ(mirror_blocks(23.5), 2);
    EXPECT_EQ(mirror_blocks(24), 3);
    EXPECT_EQ(mirror_blocks(32), 4);
    EXPECT_EQ(mirror_blocks(200), 4) << "larger ones were not measured";
}

TEST(FilmModel, OfDiscsThatTheModelExplainsIsOfPixels) {
    const Seen disc = seen(discs(), options());
    EXPECT_EQ(disc.side(), 1);
    EXPECT_THAT(disc.skipped(), Not(Contains("single pixels")));
    // What was weighed for blocks is not left behind.
    EXPECT_NEAR(disc.model.film.weighed.front().diameter, 0.89 * kScale, 0.05 * kScale);
}

// Eight blocks to a sphere then miss more.
TEST(FilmModel, OfWideEdgesIsOfPixels) {
    MirrorOptics optics = layer().optics;
    optics.blur = 0.13;
    const int side = layer().brightness.width();
    MirrorImage image(side, side, kScale, 2);
    image.render_only(MirrorScene(layer().spheres, optics));
    EXPECT_EQ(seen(with_noise(image.image()), options()).side(), 1);
}

TEST(FilmModel, IsOfPixelsWhereNoCorrectionCanHold) {
    TrackOptions unknown = options();
    unknown.sphere_diameter.reset();
    const Seen pixels = seen(mirrors(), unknown);
    EXPECT_EQ(pixels.side(), 1);
    EXPECT_THAT(pixels.model.binning_reason, HasSubstr("true diameter"));
    TrackOptions unwanted = options();
    unwanted.correct_bias = false;
    EXPECT_EQ(seen(mirrors(), unwanted).side(), 1);
    TrackOptions looked_at = options();
    looked_at.corrects_bias = false;
    EXPECT_EQ(seen(mirrors(), looked_at).side(), 1);
}

TEST(FilmModel, IsOfTheBlocksThatWereAskedFor) {
    EXPECT_EQ(seen(mirrors(), options(1)).side(), 1);
    const Seen blocks = seen(discs(), options(2));
    EXPECT_EQ(blocks.side(), 2);
    EXPECT_EQ(blocks.model.binning_reason, "as given");
}

TEST(FilmModel, OfBlocksSaysLengthsInPixels) {
    const Seen mirror = seen(mirrors(), options());
    for (const SizeCandidate& candidate : mirror.model.film.weighed) {
        EXPECT_GT(candidate.diameter, 0.6 * kScale);
        EXPECT_GT(candidate.width, 8 * kScale);
    }
    std::string size;
    for (const PlannedStage& stage : mirror.plan.stages()) {
        if (stage.stage == "diameter and edge width") size = stage.reason;
    }
    ASSERT_THAT(size, HasSubstr("D = "));
    EXPECT_NEAR(std::stod(size.substr(size.find("D = ") + 4)), 0.89 * kScale, 1) << "px";
}

TEST(FilmModel, TakesGivenLengthsInPixelsWhateverTheBlocks) {
    TrackOptions given = options(2);
    given.calibration.diameter = 0.89 * kScale;
    given.calibration.edge_width = 0.1 * kScale;
    const Seen disc = seen(discs(), given);
    const DiscProfile in_pixels = disc.model.film.calibration->model.in_pixels().disc;
    EXPECT_NEAR(in_pixels.diameter, 0.89 * kScale, 1e-9);
    EXPECT_NEAR(in_pixels.edge_width, 0.1 * kScale, 1e-9);
}

/// RMS per axis of positions against the nearest true ones, away from the border [a].
double error_of(const Snapshot& snapshot, std::size_t& found) {
    double sum = 0;
    found = 0;
    for (const Vec2 p : snapshot.position) {
        const Vec2 at = (1 / kScale) * p;
        if (std::min({at.x, at.y, kView - at.x, kView - at.y}) < 1.5) continue;
        double nearest = 1;
        for (const Point3& sphere : layer().spheres) {
            nearest = std::min(nearest, squared_norm(at - Vec2{static_cast<double>(sphere.x),
                                                               static_cast<double>(sphere.y)}));
        }
        if (nearest > 0.0625) continue;
        sum += nearest;
        ++found;
    }
    return std::sqrt(sum / (2.0 * static_cast<double>(found)));
}

TEST(FilmModel, OfBlocksFindsAsManySpheresNearlyAsExactly) {
    std::size_t by_pixels = 0;
    std::size_t by_blocks = 0;
    MemoryFrames frames({mirrors()}, {}, "frame");
    const Trajectory fine = track(frames, options(1));
    const Trajectory coarse = track(frames, options());
    const double fine_error = error_of(fine.snapshots[0], by_pixels);
    const double coarse_error = error_of(coarse.snapshots[0], by_blocks);
    EXPECT_NEAR(static_cast<double>(by_blocks), static_cast<double>(by_pixels), 1);
    EXPECT_GT(by_pixels, 120U);
    EXPECT_LT(coarse_error, 1.2 * fine_error);
    EXPECT_LT(coarse_error, 0.012);
    // Of the film, and errors with it.
    EXPECT_EQ(coarse.snapshots[0].box.length, fine.snapshots[0].box.length);
    EXPECT_EQ(coarse.info.diameter, fine.info.diameter);
    double fine_std = 0;
    double coarse_std = 0;
    for (const Vec2 e : fine.snapshots[0].position_error) fine_std += e.x;
    for (const Vec2 e : coarse.snapshots[0].position_error) coarse_std += e.x;
    EXPECT_NEAR(coarse_std / fine_std, 1, 0.25);
}

TEST(FilmModel, OfAKeptCalibrationIsOfItsBlocks) {
    MemoryFrames frames({mirrors(), mirrors()}, {}, "frame");
    RunPlan plan;
    TrackOptions first = options();
    first.keeps = true;
    Tracker tracker(frames, first, plan);
    TrackOptions second = options();
    second.kept = tracker.to_keep();
    EXPECT_EQ(second.kept->model.binning.factor, 2);
    const Seen kept = seen(mirrors(), second);
    EXPECT_EQ(kept.side(), 2);
    EXPECT_TRUE(kept.plan.warnings().empty()) << "it fits the film that it is of";

    second.binning = 1;
    EXPECT_THROW(require_consistent(second), OptionError);
    // Rendered frames need pixels.
    second.binning.reset();
    second.synthesis = true;
    EXPECT_THROW(require_consistent(second), OptionError);
}

TEST(FilmModel, OfAKeptCalibrationWarnsWhereItsBlocksCostAccuracy) {
    MemoryFrames frames({mirrors()}, {}, "frame");
    RunPlan plan;
    TrackOptions other = options();
    other.kept = Tracker(frames, options(), plan).to_keep();
    other.correct_bias = false;
    const Seen kept = seen(mirrors(), other);
    ASSERT_EQ(kept.plan.warnings().size(), 1U);
    EXPECT_THAT(kept.plan.warnings()[0].text, HasSubstr("cost accuracy"));
}

TEST(FilmModel, OfBlocksTooLargeForTheSpheresIsRefused) {
    EXPECT_THROW(require_consistent(options(4)), OptionError) << "4.25 to a sphere";
    EXPECT_NO_THROW(require_consistent(options(3)));
    TrackOptions unknown = options(32);
    unknown.sphere_diameter.reset();
    EXPECT_NO_THROW(require_consistent(unknown));
    MemoryFrames frames({mirrors()}, {}, "frame");
    RunPlan plan;
    EXPECT_THROW(model_of_film(frames, unknown, 2, plan), OptionError) << "7 across a frame";
}

TEST(FilmModel, OfLargerBlocksThanTheCorrectionKnowsIsNotCorrectedAndWarned) {
    const Seen coarse = seen(mirrors(), options(3));
    EXPECT_EQ(coarse.side(), 3);
    EXPECT_EQ(coarse.model.bias.decision.source, BiasSource::none);
    ASSERT_EQ(coarse.plan.warnings().size(), 1U);
    EXPECT_THAT(coarse.plan.warnings()[0].text, HasSubstr("leave 5.7 to a sphere"));
}

TEST(FilmModel, SaysWhyItIsOfPixels) {
    const auto why = [](const TrackOptions& given) {
        const Seen film = seen(mirrors(), given);
        for (const PlannedStage& stage : film.plan.stages()) {
            if (stage.stage == "single pixels") return stage.reason;
        }
        return std::string();
    };
    TrackOptions small = options();
    small.sphere_diameter = 15.9;
    EXPECT_THAT(why(small), HasSubstr("fewer than 8 to a sphere of 15.9 px"));
    small.sphere_diameter.reset();
    EXPECT_THAT(why(small), HasSubstr("true diameter is not known"));
    EXPECT_THAT(why(options(1)), HasSubstr("as given"));
    Image mask(mirrors().width(), mirrors().height(), 1);
    mask(3, 3) = 0;
    TrackOptions masked = options();
    masked.visible = VisiblePixels(mask);
    EXPECT_THAT(why(masked), HasSubstr("mask"));
}

// 238 px are 119 blocks of two, and 79 of three and a pixel.
TEST(FilmModel, OfBlocksReportsSpheresUpToTheSameBorder) {
    std::vector<std::size_t> found;
    for (const int side : {1, 2, 3}) {
        MemoryFrames frames({discs()}, {}, "frame");
        const Trajectory tracks = track(frames, options(side));
        found.push_back(tracks.snapshots[0].size());
        const double border = 0.25 * 0.89 * kScale;
        double nearest = kScale;
        for (const Vec2 p : tracks.snapshots[0].position) {
            nearest = std::min({nearest, p.x, p.y});
        }
        EXPECT_NEAR(nearest, border, 1.5) << side;
    }
    EXPECT_NEAR(static_cast<double>(found[1]), static_cast<double>(found[0]), 1);
    EXPECT_NEAR(static_cast<double>(found[2]), static_cast<double>(found[0]), 3);
}

TEST(FilmModel, OfBlocksWithAMaskSeesWholeBlocksOnly) {
    Image mask(discs().width(), discs().height(), 1);
    for (int y = 0; y < mask.height(); ++y) {
        for (int x = 0; x < 81; ++x) mask(x, y) = 0;
    }
    TrackOptions masked = options(2);
    masked.visible = VisiblePixels(mask);
    MemoryFrames frames({discs()}, {}, "frame");
    const Trajectory tracks = track(frames, masked);
    ASSERT_GT(tracks.snapshots[0].size(), 50U);
    for (const Vec2 p : tracks.snapshots[0].position) EXPECT_GT(p.x, 81);
}

/// The layer, a little later.
Image moved(double step) {
    std::vector<Point3> spheres = layer().spheres;
    for (Point3& p : spheres) p.x += static_cast<float>(step);
    const int side = layer().brightness.width();
    MirrorImage image(side, side, kScale, 2);
    image.render_only(MirrorScene(spheres, layer().optics));
    return with_noise(image.image());
}

// A warm frame takes no joint step before it fits meeting edges; a cold one does.
TEST(FilmModel, GivesWarmFramesThePositionsOfColdOnes) {
    const Image next = moved(0.05);
    MemoryFrames film({mirrors(), next, moved(0.1)}, {}, "film");
    const Trajectory warm = track(film, options());
    TrackOptions cold_options = options();
    RunPlan plan;
    cold_options.kept = Tracker(film, options(), plan).to_keep();
    MemoryFrames alone({next}, {}, "frame");
    const Trajectory cold = track(alone, cold_options);
    ASSERT_NEAR(static_cast<double>(warm.snapshots[1].size()),
                static_cast<double>(cold.snapshots[0].size()), 1);
    double sum = 0;
    double error = 0;
    std::size_t pairs = 0;
    for (std::size_t i = 0; i < warm.snapshots[1].size(); ++i) {
        for (const Vec2 q : cold.snapshots[0].position) {
            const double square = squared_norm(q - warm.snapshots[1].position[i]);
            if (square > 4) continue;
            sum += square / 2;
            error += squared_norm(warm.snapshots[1].position_error[i]) / 2;
            ++pairs;
        }
    }
    EXPECT_GT(pairs, 120U);
    EXPECT_LT(std::sqrt(sum / error), 0.25) << "of a standard error";
}

TEST(FilmModel, WithSynthesisIsOfPixels) {
    TrackOptions synthesis = options();
    synthesis.synthesis = true;
    EXPECT_EQ(seen(mirrors(), synthesis).side(), 1);
    synthesis.binning = 2;
    EXPECT_THROW(require_consistent(synthesis), OptionError);
}

}  // namespace
}  // namespace grainfield::tracking
