#include "tracking/calibrate/calibration.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tracking/calibrate/calibration_view.h"
#include "tracking/calibrate/colour_mosaic.h"
#include "tracking/calibrate/first_guess.h"
#include "tracking/calibrate/model_choice.h"
#include "tracking/calibrate/model_fit.h"
#include "tracking/calibrate/size_trials.h"

namespace grainfield::tracking {
namespace {

/// Single pixels of noise pass for small discs where the levels, which noise alone sets 5.2 σ
/// apart, are nearer than this many σ …
constexpr double kTellsSize = 9;
/// … discs leave more than this [contrast] …
constexpr double kMostLeft = 0.16;
/// … and, in quadrature, more than this beside the noise. Discs of the right size leave the noise
/// (0.03 at most, of 13 frames with noise of 0.18 to 0.32), half as large ones 0.077 and 0.105. The
/// misfit of steel spheres is 0.06 [contrast].
constexpr double kMostMisfit = 0.07;

void warn_of_mosaic(const Image& counts, const Levels& levels, const VisiblePixels& visible,
                    RunPlan& plan) {
    const ColourMosaic mosaic = colour_mosaic(counts, levels.low, levels.high, visible);
    if (!mosaic.is_there) return;
    plan.warn(fmt::format(
        "the image holds the colour mosaic (Bayer pattern) of a colour camera: neighbouring pixels "
        "differ by {:.1f} % in {:.0f} % of the bright cells of 2 x 2; give its "
        "colour filter (option 'mosaic'), or positions are drawn to the grid of the filter",
        100 * mosaic.strength, 100 * mosaic.share));
}

/// Whether what was found may be single pixels of noise.
bool passes_for_noise(const ImageModel& model, const ModelFit& fit, const Image& work) {
    if (fit.options.diameter) return false;
    const double contrast =
        model.background(0.5 * work.width(), 0.5 * work.height()) - model.dark_level;
    const double misfit = std::sqrt(
        std::max(0.0, std::pow(model.residual_rms, 2) - std::pow(fit.levels.noise / contrast, 2)));
    return model.residual_rms > kMostLeft && misfit > kMostMisfit &&
           fit.levels.high - fit.levels.low < kTellsSize * fit.levels.noise;
}

void warn_of_noise(const ImageModel& model, const Levels& levels, RunPlan& plan) {
    plan.warn(fmt::format(
        "too noisy to tell the size of the spheres: the noise is {:.2f} of the span of the "
        "image, discs of D = {:.1f} px leave {:.2f} of the contrast; give "
        "calibrate.disc-diameter",
        levels.noise / (levels.high - levels.low), disc_in_pixels(model).diameter,
        model.residual_rms));
}

/// Disc and background, in words.
void say_what_was_fitted(const ImageModel& model, const ModelFit& fit, RunPlan& plan) {
    const CalibrationOptions& options = fit.options;
    const EdgeFit& edges = fit.edges;
    if (edges.pixels == 0) {
        plan.warn("no exposed edges to measure diameter and edge width on; first guesses kept");
    } else if (!edges.converged) {
        plan.warn(fmt::format(
            "the fit of diameter and edge width to exposed edges did not converge; D = {:.2f} px "
            "and w = {:.2f} px are those before it; both can be given (calibrate.disc-diameter, "
            "calibrate.edge-width)",
            disc_in_pixels(model).diameter, disc_in_pixels(model).edge_width));
    }
    plan.run("diameter and edge width",
             options.diameter && options.edge_width
                 ? std::string("given")
                 : fmt::format("D = {:.2f} px, w = {:.2f} px from {} {} of exposed edges",
                               disc_in_pixels(model).diameter, disc_in_pixels(model).edge_width,
                               edges.pixels, fit.blocks.is_none() ? "pixels" : "blocks"));
    if (model.background.is_uniform()) {
        plan.skip("background surface",
                  fmt::format("illumination uniform to {:.1f} % of the contrast",
                              100 * options.uniform_tolerance),
                  "one polynomial a pixel");
    } else {
        plan.run("background surface", "illumination is uneven");
    }
}

}  // namespace

std::string blank_reason(const Image& counts, const VisiblePixels& visible) {
    // Where spheres are many a few pixels show it, beyond doubt.
    constexpr int kSparsely = 4;
    constexpr std::size_t kEnough = std::size_t{1} << 19;  // pixels
    constexpr double kClearly = 20;                        // times the noise
    if (counts.size() >= kEnough && visible.are_all()) {
        const Levels levels = levels_of(counts, visible, kSparsely);
        const double contrast = levels.high - levels.low;
        if (contrast > kClearly * levels.noise && blank_reason(levels).empty()) return {};
    }
    return blank_reason(levels_of(counts, visible));
}

std::optional<Calibration> calibrate(const Image& counts, const CalibrationOptions& options,
                                     const DetectionOptions& detection,
                                     const RefinementOptions& refinement, int threads,
                                     RunPlan& plan, const VisiblePixels& visible,
                                     std::vector<SizeCandidate>* weighed) {
    std::vector<SizeCandidate> unseen;
    std::vector<SizeCandidate>& candidates = weighed != nullptr ? *weighed : unseen;
    candidates.clear();
    const Levels levels = levels_of(counts, visible);
    // Before the rest: it passes for noise.
    warn_of_mosaic(counts, levels, visible, plan);
    if (const std::string reason = blank_reason(levels); !reason.empty()) {
        plan.warn(reason);
        return std::nullopt;
    }
    const ModelFit by_pixels{.options = options,
                             .detection = detection,
                             .refinement = refinement,
                             .threads = threads,
                             .levels = levels,
                             .visible = visible};
    CalibrationView view = view_by({options.binning.factor}, counts, by_pixels);
    RunPlan attempt;
    std::optional<SizeTrial> best = best_trial(view.counts, view.fit, attempt, candidates);
    const bool is_done =
        best ? blocks_are_enough(options.binning, best->model) : !options.binning.widest_edge;
    if (options.binning.factor > 1 && !is_done) {
        view = view_by({}, counts, by_pixels);
        best = best_trial(view.counts, view.fit, plan, candidates);
    } else {
        plan.take(attempt);
    }
    if (!best) return std::nullopt;

    // From here on in terms of dark spheres; the sign is undone at the end.
    const bool bright = best->polarity == Polarity::bright;
    const Image work = bright ? turned_round(view.counts) : std::move(view.counts);
    ImageModel model = best->model;
    ModelFit fit = best->fit;
    if (!best->is_whole) {
        fit.visible = view.fit.visible;
        fit.positions.clear();
        fit.settle(model, work, ModelFit::kFrameRounds);
    }
    if (passes_for_noise(model, fit, work)) {
        warn_of_noise(model, fit.levels, plan);
        return std::nullopt;
    }
    say_what_was_fitted(model, fit, plan);
    choose_model(work, fit.positions, fit.options, fit.detection, fit.refinement, threads,
                 fit.visible, model, plan);
    const bool is_complete = fit.complete(model, work, plan);
    if (bright) {
        model.background = model.background.negated();
        model.dark_level = -model.dark_level;
        model.polarity = Polarity::bright;
    }
    return Calibration{std::move(model), std::move(fit.positions), is_complete};
}

}  // namespace grainfield::tracking
