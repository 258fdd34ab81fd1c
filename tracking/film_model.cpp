#include "tracking/film_model.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

namespace grainfield::tracking {
namespace {

constexpr double kLeastBlocks = 8;    // [a] of the cameras of the general correction
constexpr double kNearlyWhole = 0.01;  // a diameter that was rounded down counts as the whole one
constexpr int kLargestBlock = 8;      // [px]

/// Side of the blocks by which mirror-like spheres are seen as well [px]; 1: by none.
int blocks_for_mirrors(const TrackOptions& options) {
    const bool is_whole = options.visible.are_all() && !options.camera;
    const bool is_corrected = options.corrects_bias && options.correct_bias.value_or(true);
    if (!options.sphere_diameter || !is_whole || !is_corrected || needs_pixels(options) ||
        options.calibration.polarity == PolarityChoice::bright ||
        options.calibration.profile.learning != Learning::never) {
        return 1;
    }
    return mirror_blocks(*options.sphere_diameter);
}

FilmModel calibrated(FrameSource& source, const TrackOptions& options, BinningUse binning,
                     int threads, RunPlan& plan) {
    CalibrationOptions calibration = options.calibration;
    calibration.binning = binning;
    FilmModel model{.film = calibrate_film(source, calibration, options.detection,
                                           options.refinement, options.visible, threads, plan),
                    .bias = {}};
    if (model.film.calibration) {
        model.bias = bias_of_film(source, options, model.film.calibration->model,
                                  model.film.weighed_at, threads, plan);
    }
    return model;
}

FilmModel kept_model(FrameSource& source, const TrackOptions& options, int threads, RunPlan& plan) {
    FilmModel model{.film = use_kept(*options.kept, source, options.visible, threads, plan),
                    .bias = {}};
    ImageModel& image = model.film.calibration->model;
    if (needs_pixels(options)) image = image.in_pixels();
    model.bias = bias_of_film(source, options, image, model.film.weighed_at, threads, plan);
    return model;
}

void say_blocks(const FilmModel& model, RunPlan& plan) {
    const int side = model.film.calibration->model.binning.factor;
    plan.skip("single pixels",
              fmt::format("fitted by blocks of {0} x {0} px, which tell as much where mirror images "
                          "limit positions",
                          side),
              "half of the time, or more");
}

}  // namespace

int mirror_blocks(double diameter) {
    return std::clamp(static_cast<int>(diameter / kLeastBlocks + kNearlyWhole), 1, kLargestBlock);
}

FilmModel model_of_film(FrameSource& source, const TrackOptions& options, int threads,
                        RunPlan& plan) {
    if (options.kept) return kept_model(source, options, threads, plan);
    if (options.binning > 0) {
        return calibrated(source, options, {options.binning}, threads, plan);
    }
    const int side = blocks_for_mirrors(options);
    if (side == 1) return calibrated(source, options, {}, threads, plan);
    RunPlan attempt;
    FilmModel model = calibrated(source, options, {.factor = side, .only_for_misfit = true},
                                 threads, attempt);
    const bool is_binned =
        model.film.calibration && !model.film.calibration->model.binning.is_none();
    if (is_binned && model.bias.decision.source != BiasSource::general) {
        plan.run("single pixels", "blocks were tried: " + model.bias.decision.reason);
        return calibrated(source, options, {}, threads, plan);
    }
    plan.take(attempt);
    if (is_binned) say_blocks(model, plan);
    return model;
}

}  // namespace grainfield::tracking
