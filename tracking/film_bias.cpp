#include "tracking/film_bias.h"

#include <cmath>
#include <string>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "tracking/run_clock.h"
#include "tracking/synthesis/bias_learning.h"
#include "tracking/synthesis/general_correction.h"

namespace grainfield::tracking {
namespace {

constexpr double kSameSetting = 1e-3;  // relative: 0.1 % of a changes no correction by its error

BiasSetting setting_of(const TrackOptions& options) {
    return {.diameter = options.sphere_diameter.value_or(0),
            .height = options.layers.height.value_or(options.synthesis_options.height),
            .camera_distance = options.layers.camera_distance.value_or(0),
            .detection = options.detection,
            .refinement = options.refinement,
            .verbosity = options.verbosity};
}

/// Chosen: what discs leave is small beside the noise below this share of it.
constexpr double kLeastMisfit = 0.5;
/// Of the cameras that the general correction was learned from, less what rounding may take [a].
constexpr double kLeastBlocks = 7.9;
/// Fewer do not show whether a correction holds.
constexpr int kLeastSpheres = 30;

/// Why the general correction is not looked at; empty: it is.
std::string not_for_this_film(const TrackOptions& options, const ImageModel& model) {
    if (!options.sphere_diameter) return "the true diameter is not known (track.sphere-diameter)";
    if (model.polarity != Polarity::dark) return "bright spheres mirror no panel";
    if (options.camera) return "it holds for frames as a straight lens sees them";
    if (!options.visible.are_all()) {
        return "it holds for whole frames, and a mask hides a part; a region leaves out a rim "
               "without one";
    }
    const double diameter = *options.sphere_diameter / model.binning.factor;
    if (is_unusual_size(model.disc.diameter, diameter)) {
        return "discs of this size are no usual picture of spheres of track.sphere-diameter";
    }
    const double left = std::sqrt(
        std::max(0.0, model.residual_rms * model.residual_rms - model.noise * model.noise));
    if (left < kLeastMisfit * model.noise) {
        return fmt::format(
            "discs explain the film: they leave {:.4f} of the contrast beyond noise of {:.4f}",
            left, model.noise);
    }
    if (!model.binning.is_none() && diameter < kLeastBlocks) {
        return fmt::format(
            "blocks of {} px leave {:.1f} to a sphere, the correction was learned from 8 on",
            model.binning.factor, diameter);
    }
    return general_correction().refused(model.disc, diameter);
}

/// The first usable frame from `first` on; empty: there is none.
std::optional<Frame> usable_frame(FrameSource& source, std::int64_t first,
                                  const VisiblePixels& visible) {
    for (std::int64_t at = first; at < source.count(); ++at) {
        Frame frame = source.read(at);
        throw_if_interrupted("tracking");
        if (frame.status == FrameStatus::ok && blank_reason(frame.image, visible).empty()) {
            return frame;
        }
    }
    return std::nullopt;
}

/// Why a kept correction is of no use in this run; empty: it is of use.
std::string no_use_of_kept(const TrackOptions& options) {
    if (options.synthesis) return "synthesis has no such bias";
    if (options.camera) return "it holds for frames as a straight lens sees them";
    if (!options.visible.are_all()) return "it holds for whole frames, and a mask hides a part";
    return {};
}

/// Throws OptionError where the correction was learned for something else.
void require_same(const BiasCorrection& kept, const TrackOptions& options) {
    const BiasSetting now = setting_of(options);
    const auto require = [](const char* what, const char* unit, double then, double given) {
        if (std::abs(given - then) <= kSameSetting * then) return;
        throw OptionError(
            {.problem = "the kept correction of the bias does not hold here",
             .actual = given > 0 ? fmt::format("{} of {:g} {}", what, given, unit)
                                 : fmt::format("{} is not given", what),
             .expected = fmt::format("{:g} {}, for which it was learned", then, unit),
             .suggestion =
                 "give that value, or switch track.correct-bias off, or calibrate again with "
                 "it"});
    };
    require("track.sphere-diameter", "px", kept.diameter, now.diameter);
    require("layers.height", "a", kept.height, now.height);
    require("layers.camera-distance", "a", kept.camera_distance, now.camera_distance);
}

constexpr const char* kSaved = "half of what mirror images of neighbours do to positions";
constexpr const char* kCorrected = "corrected positions";

/// Positions stay those of the discs.
FilmBias without(const std::string& reason, RunPlan& plan, const char* saved = kSaved) {
    plan.skip("bias", reason, saved);
    return {std::nullopt, {.moved = {}, .reason = reason}};
}

/// What is not looked at yet.
FilmBias undecided(const char* what, RunPlan& plan) {
    plan.run("bias", what);
    return {std::nullopt, {.moved = {}, .reason = what}};
}

/// What tells that spheres are no mirrors; empty: nothing does.
std::string not_as_mirrors(const CorrectionJudgement& judgement) {
    if (!(judgement.unlikeness <= CorrectionJudgement::kMostUnlike)) {
        return fmt::format(
            "what discs leave is {:.1f} spreads from that of mirrors, {:.1f} at most",
            judgement.unlikeness, CorrectionJudgement::kMostUnlike);
    }
    if (judgement.is_unlike()) {
        return fmt::format(
            "what discs leave is as of discs with a rim: the log odds of mirrors are "
            "{:.1f}, {:.1f} at least",
            judgement.log_odds, CorrectionJudgement::kLeastOdds);
    }
    if (judgement.is_too_large()) {
        return fmt::format(
            "the general correction would move them by {:.4f} a RMS beside errors of "
            "{:.4f} a, by {:g} times as much at most",
            judgement.moved, judgement.expected, CorrectionJudgement::kMostMoved);
    }
    return {};
}

/// That of many cameras, if it holds for the film.
FilmBias general_bias(FrameSource& source, const TrackOptions& options, const ImageModel& model,
                      std::int64_t first, int threads, RunPlan& plan) {
    const std::string reason = not_for_this_film(options, model);
    if (!reason.empty()) return without(reason, plan);
    if (!options.corrects_bias) {
        return undecided("whether the general correction holds is seen on the first usable frame",
                         plan);
    }
    const std::optional<Frame> frame = usable_frame(source, first, options.visible);
    if (!frame) return without("no frame is usable", plan);
    const double diameter = *options.sphere_diameter / model.binning.factor;
    const GeneralCorrection& general = general_correction();
    // By pixels, whatever the film is fitted by: silhouettes by blocks look like mirrors.
    const CorrectionJudgement judgement =
        judge_correction(general, frame->image, model.in_pixels(), options.detection,
                         options.refinement, *options.sphere_diameter, threads);
    if (judgement.spheres < kLeastSpheres) {
        return without(fmt::format("{} spheres in the middle of the frame do not show whether the "
                                   "general correction holds, {} would",
                                   judgement.spheres, kLeastSpheres),
                       plan);
    }
    if (const std::string unlike = not_as_mirrors(judgement); !unlike.empty()) {
        return without("these look like no mirrors above a panel: " + unlike, plan);
    }
    BiasDecision decision{.source = BiasSource::general,
                          .cameras = general.cameras,
                          .moved = judgement.moved,
                          .before = general.before,
                          .after = general.after,
                          .reason = {}};
    plan.run("bias",
             (options.synthesis ? "positions that synthesis begins with are " : "positions are ") +
                 in_words(decision));
    return {general.of(model.disc, diameter), std::move(decision)};
}

}  // namespace

FilmBias bias_of_film(FrameSource& source, const TrackOptions& options, const ImageModel& model,
                      std::int64_t first, int threads, RunPlan& plan) {
    if (!options.correct_bias.value_or(true)) {
        return without("not wanted (track.correct-bias is off)", plan);
    }
    if (options.kept && options.kept->bias) {
        const BiasCorrection& kept = *options.kept->bias;
        const std::string no_use = no_use_of_kept(options);
        if (!no_use.empty()) {
            if (options.synthesis) {
                return general_bias(source, options, model, first, threads, plan);
            }
            return without(no_use, plan, kCorrected);
        }
        if (!options.sphere_diameter) {
            plan.warn(fmt::format(
                "positions are not corrected: the kept correction is of spheres of {:g} px, and "
                "none is given; give that as track.sphere-diameter if they are the same",
                kept.diameter));
            return without("the true diameter is not given (track.sphere-diameter)", plan,
                           kCorrected);
        }
        require_same(kept, options);
        BiasDecision decision{.source = BiasSource::film,
                              .moved = {},
                              .before = kept.before,
                              .after = kept.after,
                              .reason = {}};
        plan.run("bias",
                 fmt::format("positions are {}; kept with the calibration", in_words(decision)));
        return {kept, std::move(decision)};
    }
    if (!options.correct_bias) {
        return general_bias(source, options, model, first, threads, plan);
    }
    if (model.polarity != Polarity::dark) {
        throw OptionError({.problem = "the bias of the discs cannot be corrected",
                           .actual = "bright spheres on a dark background",
                           .expected = "mirror-like spheres before a bright panel: dark discs",
                           .suggestion = "leave out track.correct-bias"});
    }
    if (!options.corrects_bias) {
        return undecided("how discs err is learned on the first usable frame", plan);
    }
    const std::optional<Frame> frame = usable_frame(source, first, options.visible);
    if (!frame) return without("no frame is usable", plan, kCorrected);
    const BiasSetting setting = setting_of(options);
    const auto begin = RunClock::now();
    const BiasLearning learned = learn_bias(frame->image, model, setting, threads);
    const double seconds = 1e-3 * milliseconds_since(begin);
    if (!learned.refused.empty()) {
        plan.warn(fmt::format("no correction is learned from the film: {}", learned.refused));
        return general_bias(source, options, model, first, threads, plan);
    }
    BiasDecision decision{.source = BiasSource::film,
                          .moved = {},
                          .before = learned.correction.before,
                          .after = learned.correction.after,
                          .reason = {}};
    plan.run("bias", fmt::format("positions are {}: {} spheres of {} frames, {:.0f} s",
                                 in_words(decision), learned.spheres, learned.frames, seconds));
    return {learned.correction, std::move(decision)};
}

}  // namespace grainfield::tracking
