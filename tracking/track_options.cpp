#include "tracking/track_options.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::tracking {
namespace {

// A tenth beyond what spheres show: 1/√2 (the core of a mirror, docs/render/optics.md) to 1.
constexpr double kLeastApparent = 0.63;  // [a]
constexpr double kMostApparent = 1.1;    // [a]
/// Discs of fewer blocks, or pixels, are not told from noise.
constexpr double kLeastBlocks = 5;

/// Throws OptionError where an option needs another one.
void require_diameter(const TrackOptions& options) {
    if (options.layers.height && !options.sphere_diameter) {
        throw OptionError(
            ErrorText{"the height of the cell needs the true diameter of the spheres",
                      "track.sphere-diameter is not known", "a [px], the unit of layers.height",
                      "the dark disc is smaller than the sphere; measure the sphere"});
    }
    if (options.synthesis && !options.sphere_diameter) {
        throw OptionError(
            ErrorText{"synthesis needs the true diameter of the spheres",
                      "track.sphere-diameter is not known", "a [px]",
                      "give track.sphere-diameter; the dark disc is smaller than the sphere"});
    }
    if (options.synthesis && options.camera) {
        throw OptionError(
            {.problem = "synthesis cannot be corrected for lens and tilt",
             .actual = "a camera is given",
             .expected = "no camera: equal spheres are rendered from straight above, and a lens or "
                         "a tilt would be taken for heights",
             .suggestion = options.layers.height
                               ? "leave out track.synthesis: x, y and layers come from the discs, "
                                 "corrected; or leave out the camera, where it moves positions by "
                                 "less than they may err"
                               : "leave out track.synthesis: with layers.height the layers come "
                                 "from the discs, corrected; or leave out the camera, where it "
                                 "moves positions by less than they may err"});
    }
    if (options.synthesis && !options.visible.are_all()) {
        throw OptionError(ErrorText{"synthesis renders whole frames", "a mask hides part of them",
                                    "no mask", "choose a region without hidden pixels instead"});
    }
}

[[noreturn]] void refuse_bias(const char* actual, const char* expected, const char* suggestion) {
    throw OptionError(
        ErrorText{"the bias of the discs cannot be corrected", actual, expected, suggestion});
}

/// Throws OptionError where a correction of the bias cannot be learned.
void require_mirrors(const TrackOptions& options) {
    if (!options.sphere_diameter) {
        refuse_bias("track.sphere-diameter is not known", "a [px]",
                    "give track.sphere-diameter, the dark disc is smaller than the sphere");
    }
    if (options.synthesis) {
        refuse_bias(
            "synthesis is asked for, too", "either of them",
            "leave out track.correct-bias: synthesis begins at corrected positions by itself");
    }
    if (options.camera) {
        refuse_bias("a camera is given", "frames as a straight lens sees them",
                    "leave out the camera");
    }
    if (!options.visible.are_all()) {
        refuse_bias("a mask hides part of the frames", "no mask",
                    "choose a region without hidden pixels instead");
    }
}

/// Throws OptionError where rendered frames are compared with blocks.
void require_pixels(const TrackOptions& options) {
    if (!needs_pixels(options)) return;
    const int kept = options.kept ? options.kept->model.binning.factor : 1;
    const int blocks = options.binning.value_or(kept);
    if (blocks == 1 && kept == 1) return;
    throw OptionError(
        {.problem = "frames are rendered pixel by pixel, and cannot be compared with blocks",
         .actual = fmt::format("{}, with {}",
                               kept > 1 ? fmt::format("a kept calibration of blocks of {} px", kept)
                                        : fmt::format("track.binning is {}", blocks),
                               options.synthesis ? "track.synthesis" : "track.correct-bias"),
         .expected = "pixels",
         .suggestion =
             kept > 1 ? "calibrate again, with track.binning 1" : "leave out track.binning"});
}

/// Throws OptionError where blocks are too large for the spheres, or others than a kept
/// calibration is of.
void require_useful_blocks(const TrackOptions& options) {
    if (!options.binning) return;
    const int given = *options.binning;
    if (options.kept && given != options.kept->model.binning.factor) {
        throw OptionError(
            {.problem = "a kept calibration is of blocks of its own",
             .actual = fmt::format("track.binning is {}", given),
             .expected = fmt::format("{}, as calibrated", options.kept->model.binning.factor),
             .suggestion = "leave out the option, or calibrate again"});
    }
    const std::optional<double> known =
        options.sphere_diameter ? options.sphere_diameter : options.calibration.diameter;
    if (!known || given == 1 || *known >= kLeastBlocks * given) return;
    throw OptionError(
        {.problem = "blocks are too large for the spheres",
         .actual = fmt::format("track.binning is {}, of spheres of {:g} px", given, *known),
         .expected =
             fmt::format("{} at most, which leaves {:g} blocks to a sphere",
                         std::max(1, static_cast<int>(*known / kLeastBlocks)), kLeastBlocks),
         .suggestion = "give less, or leave out track.binning"});
}

}  // namespace

std::vector<OptionTable> describe(TrackOptions& options) {
    OptionTable track("track");
    track.number(
        "sphere-diameter", options.sphere_diameter, "px", {2, 2000},
        "true diameter a of a sphere: unit of the analysis, and which spheres have room; auto: the "
        "apparent one, no room asked for");
    track.flag("synthesis", options.synthesis,
               "positions and heights of mirror-like spheres by rendering the frame");
    track.flag(
        "correct-bias", options.correct_bias,
        "correct positions for mirror images of neighbours as learned from frames that are "
        "rendered with the optics of the film (10 to 40 s of a core), kept with its calibration; "
        "no: not at all; auto: as learned from other cameras, where spheres look like mirrors");
    track.integer(
        "binning", options.binning, "px", {1, 32},
        "fit frames by blocks of that many pixels a side, which takes less time; 1: pixel "
        "by pixel; auto: as many as leave 8 to a sphere, 4 at most, where it is a mirror");
    track.integer("stretch", options.stretch, "frames", {2, 1e9},
                  "frames that start from one another; then the search begins afresh, so that "
                  "parts of a film give what the whole film gives");
    return {describe(options.calibration),
            describe(options.detection),
            describe(options.refinement),
            describe(options.link),
            describe(options.layers),
            describe(options.synthesis_options),
            track};
}

bool needs_pixels(const TrackOptions& options) {
    return options.synthesis || options.correct_bias.value_or(false) ||
           (options.kept && options.kept->bias);
}

DetectionOptions detection_of(const TrackOptions& options) {
    DetectionOptions detection = options.detection;
    if (options.sphere_diameter) detection.sphere_diameter = options.sphere_diameter;
    if (options.layers.height) detection.cell_height = *options.layers.height;
    return detection;
}

bool is_unusual_size(double apparent, double diameter) {
    const double share = apparent / diameter;
    return share < kLeastApparent || share > kMostApparent;
}

void warn_of_unusual_size(double apparent, const TrackOptions& options, RunPlan& plan) {
    if (!options.sphere_diameter || !is_unusual_size(apparent, *options.sphere_diameter)) return;
    const double share = apparent / *options.sphere_diameter;
    plan.warn(fmt::format(
        "the spheres look {:.1f} px wide, {:.2f} of the {:g} px of track.sphere-diameter; steel "
        "shows 0.7 to 0.95, a silhouette 1. Every length is in units of it: is it the diameter, in "
        "pixels of these frames?",
        apparent, share, *options.sphere_diameter));
}

void require_consistent(const TrackOptions& options) {
    require_diameter(options);
    require_pixels(options);
    if (options.correct_bias.value_or(false)) require_mirrors(options);
    require_useful_blocks(options);
    if (options.kept && options.calibration != CalibrationOptions{}) {
        throw OptionError({.problem = "a kept calibration leaves nothing to estimate",
                           .actual = "options of the section calibrate are given as well",
                           .expected = "either of them",
                           .suggestion = "leave out the options, or calibrate again"});
    }
}

}  // namespace grainfield::tracking
