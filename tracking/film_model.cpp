#include "tracking/film_model.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::tracking {
namespace {

constexpr double kLeastBlocks = 8;     // [a] of the cameras of the general correction
constexpr double kNearlyWhole = 0.01;  // a diameter that was rounded down counts as the whole one
constexpr int kLargestBlock = 4;       // [px]; larger ones were not measured
// Where edges are wider, eight blocks to a sphere find fewer: at .143 a as many as pixels, at .156
// a 26 of 10,781 are missed in place of 5.
constexpr double kWidestEdge = 0.15;     // [a]
constexpr double kSteelDiameter = 0.88;  // D of polished steel over a panel [a]
constexpr int kLeastFrame = 32;          // [blocks] across, of any use

/// Why blocks are not tried; empty: they are.
std::string not_by_blocks(const TrackOptions& options) {
    if (needs_pixels(options)) return "frames are compared with rendered ones";
    if (!options.correct_bias.value_or(true)) return "track.correct-bias is off";
    if (!options.sphere_diameter) return "the true diameter is not known (track.sphere-diameter)";
    if (mirror_blocks(*options.sphere_diameter) == 1) {
        return fmt::format("blocks of 2 x 2 px leave fewer than {:g} to a sphere of {:g} px",
                           kLeastBlocks, *options.sphere_diameter);
    }
    if (options.calibration.polarity == PolarityChoice::bright) return "bright spheres";
    if (options.calibration.profile.learning != Learning::never) return "a profile is learned";
    if (options.camera) return "a camera is given";
    if (!options.visible.are_all()) return "a mask hides a part";
    return {};
}

/// Throws OptionError where hardly any block is left.
void require_blocks(int side, const FrameSource& source) {
    const int least = std::min(source.width(), source.height());
    if (side == 1 || least >= kLeastFrame * side) return;
    throw OptionError({.problem = "frames are too small for blocks of that size",
                       .actual = fmt::format("track.binning is {}, frames have {} x {} px", side,
                                             source.width(), source.height()),
                       .expected = fmt::format("{} at most", std::max(1, least / kLeastFrame)),
                       .suggestion = "leave out track.binning, or give 1"});
}

constexpr const char* kAsKept = "as kept with the calibration";
constexpr const char* kAsGiven = "as given";

FilmModel calibrated(FrameSource& source, const TrackOptions& options, BinningUse binning,
                     const std::string& reason, int threads, RunPlan& plan) {
    CalibrationOptions calibration = options.calibration;
    calibration.binning = binning;
    FilmModel model{.film = calibrate_film(source, calibration, options.detection,
                                           options.refinement, options.visible, threads, plan),
                    .bias = {},
                    .binning_reason = reason};
    if (model.film.calibration) {
        model.bias = bias_of_film(source, options, model.film.calibration->model,
                                  model.film.weighed_at, threads, plan);
    }
    return model;
}

std::string in_blocks_words(int side) {
    return fmt::format("frames are fitted by blocks of {0} x {0} px", side);
}

FilmModel kept_model(FrameSource& source, const TrackOptions& options, int threads, RunPlan& plan) {
    FilmModel model{.film = use_kept(*options.kept, source, options.visible, threads, plan),
                    .bias = {},
                    .binning_reason = kAsKept};
    const ImageModel& image = model.film.calibration->model;
    model.bias = bias_of_film(source, options, image, model.film.weighed_at, threads, plan);
    if (image.binning.is_none()) {
        plan.run("single pixels", kAsKept);
        return model;
    }
    plan.run("blocks", in_blocks_words(image.binning.factor) + ", " + kAsKept);
    if (options.corrects_bias && model.bias.decision.source != BiasSource::general) {
        plan.warn(
            fmt::format("the kept calibration is of blocks of {0} x {0} px, which cost accuracy "
                        "where positions are not corrected for mirror images. They are not: {1}. "
                        "Calibrate again with track.binning 1",
                        image.binning.factor, model.bias.decision.reason));
    }
    return model;
}

FilmModel by_given_blocks(FrameSource& source, const TrackOptions& options, int threads,
                          RunPlan& plan) {
    const int side = *options.binning;
    if (side == 1) {
        plan.run("single pixels", fmt::format("{} (track.binning)", kAsGiven));
    } else {
        plan.run("blocks", fmt::format("{}, {} (track.binning)", in_blocks_words(side), kAsGiven));
    }
    FilmModel model = calibrated(source, options, {side}, kAsGiven, threads, plan);
    if (side == 1) return model;
    if (!model.film.calibration) {
        plan.warn(fmt::format(
            "by blocks of {0} x {0} px no spheres were found: leave out track.binning", side));
        return model;
    }
    // Where the true diameter is not known, discs stand for it.
    const double left = options.sphere_diameter
                            ? *options.sphere_diameter / side
                            : model.film.calibration->model.disc.diameter / kSteelDiameter;
    if (left < kLeastBlocks - kNearlyWhole) {
        plan.warn(fmt::format(
            "blocks of {0} x {0} px leave {1:.1f} to a sphere: below {2:g} positions get worse, "
            "and are not corrected for mirror images",
            side, left, kLeastBlocks));
    }
    return model;
}

/// By blocks where the general correction then holds; else by pixels.
FilmModel tried_by_blocks(FrameSource& source, const TrackOptions& options, int side, int threads,
                          RunPlan& plan) {
    RunPlan attempt;
    FilmModel model = calibrated(
        source, options, {.factor = side, .widest_edge = kWidestEdge * *options.sphere_diameter},
        "mirror images, not resolution, limit positions", threads, attempt);
    if (!model.film.calibration) {
        const std::string reason = "by blocks no spheres were found";
        plan.run("single pixels", reason);
        return calibrated(source, options, {}, reason, threads, plan);
    }
    const bool is_binned = !model.film.calibration->model.binning.is_none();
    if (is_binned && model.bias.decision.source != BiasSource::general) {
        const std::string reason = "blocks were tried: " + model.bias.decision.reason;
        plan.run("single pixels", reason);
        return calibrated(source, options, {}, reason, threads, plan);
    }
    plan.take(attempt);
    if (!is_binned) {
        const ImageModel& image = model.film.calibration->model;
        const double width = image.disc.edge_width / *options.sphere_diameter;
        model.binning_reason =
            width > kWidestEdge
                ? fmt::format("edges are {:.3f} a wide, {:g} a at most", width, kWidestEdge)
                : fmt::format(
                      "a first fit of blocks leaves little beside noise, or has edges "
                      "wider than {:g} a",
                      kWidestEdge);
        plan.run("single pixels", model.binning_reason);
    } else {
        plan.skip(
            "single pixels",
            fmt::format("{}: {} (track.binning)", in_blocks_words(side), model.binning_reason),
            "half of the time");
    }
    return model;
}

}  // namespace

int mirror_blocks(double diameter) {
    return std::clamp(static_cast<int>(diameter / kLeastBlocks + kNearlyWhole), 1, kLargestBlock);
}

FilmModel model_of_film(FrameSource& source, const TrackOptions& options, int threads,
                        RunPlan& plan) {
    if (options.kept) return kept_model(source, options, threads, plan);
    if (options.binning) {
        require_blocks(*options.binning, source);
        return by_given_blocks(source, options, threads, plan);
    }
    const std::string reason = not_by_blocks(options);
    if (!reason.empty()) {
        plan.run("single pixels", reason);
        return calibrated(source, options, {}, reason, threads, plan);
    }
    const int side = mirror_blocks(*options.sphere_diameter);
    if (!options.corrects_bias) {
        const std::string undecided = fmt::format(
            "whether frames are fitted by blocks of {0} x {0} px is seen on the first usable frame",
            side);
        plan.run("blocks", undecided);
        return calibrated(source, options, {}, undecided, threads, plan);
    }
    return tried_by_blocks(source, options, side, threads, plan);
}

}  // namespace grainfield::tracking
