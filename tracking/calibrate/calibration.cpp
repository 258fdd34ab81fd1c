#include "tracking/calibrate/calibration.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tracking/calibrate/background.h"
#include "tracking/calibrate/colour_mosaic.h"
#include "tracking/calibrate/edge_fit.h"
#include "tracking/calibrate/explained_share.h"
#include "tracking/calibrate/first_guess.h"
#include "tracking/calibrate/model_choice.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

/// The fit starts from what the image says of its edges, at most from this [D]: noise, and edges
/// that merge, make a rough width too large.
constexpr double kWidestFirstEdge = 0.12;
constexpr double kNarrowestFirstEdge = 0.1;  // [px]
/// A first guess that explains this share of the image, noise left aside, needs no rival …
constexpr double kGood = 0.95;
/// … if it explains this share of all: the noise of small discs is not well known.
constexpr double kGoodOfAll = 0.5;
/// … and if the image tells twice as many values apart as were fitted.
constexpr double kResolved = 2;
/// Single pixels of noise pass for small discs where the levels, which noise alone sets 5.2 σ
/// apart, are nearer than this many σ …
constexpr double kTellsSize = 9;
/// … discs leave more than this [contrast] …
constexpr double kMostLeft = 0.16;
/// … and, in quadrature, more than this beside the noise. Discs of the right size leave the noise
/// (0.03 at most, of 13 frames with noise of 0.18 to 0.32), half as large ones 0.077 and 0.105. The
/// misfit of steel spheres is 0.06 [contrast].
constexpr double kMostMisfit = 0.07;
/// A model describes the frame where this share of the residual's variance is not noise.
constexpr double kLittleMisfit = 0.2;
/// Frames are seen by blocks where a first fit leaves this many times the noise.
constexpr double kMisfitForBlocks = 2;
constexpr int kRounds = 4;
constexpr int kFrameRounds = 2;
constexpr int kImageRounds = 6;

struct Patch {
    Image image;
    int x = 0, y = 0;  ///< its first pixel in the frame
};

/// The square of about 30 diameters that is brightest on average, thus most dilute; the whole frame
/// if it is not much larger. At least half of it is visible.
Patch clearest_patch(const Image& counts, const ImageModel& model, const VisiblePixels& visible) {
    const int side = std::max(256, static_cast<int>(30 * model.disc.diameter));
    if (counts.width() < 3 * side / 2 || counts.height() < 3 * side / 2) return {counts, 0, 0};
    const Image darkness = model.darkness(counts);
    double best = 0;
    Patch patch;
    for (int y = 0; y + side <= counts.height(); y += side / 4) {
        for (int x = 0; x + side <= counts.width(); x += side / 4) {
            double sum = 0;
            double seen = 0;
            for (int row = y; row < y + side; row += 2) {
                for (int column = x; column < x + side; column += 2) {
                    if (!visible(column, row)) continue;
                    sum += static_cast<double>(darkness(column, row));
                    seen += 1;
                }
            }
            if (seen < 0.125 * side * side) continue;
            // A patch without spheres teaches nothing.
            const double mean = sum / seen;
            const double score = mean < 0.1 ? 1 - mean : mean;
            if (best == 0 || score < best) {
                best = score;
                patch.x = x;
                patch.y = y;
            }
        }
    }
    if (best == 0) return {counts, 0, 0};
    patch.image = Image(side, side);
    for (int y = 0; y < side; ++y) {
        std::copy_n(counts.row(patch.y + y) + patch.x, side, patch.image.row(y));
    }
    return patch;
}

/// The disc in pixels of the frame.
DiscProfile in_pixels(const ImageModel& model) {
    return model.binning.in_frame(model.disc);
}

/// Improves a model on an image, step by step.
struct Fitter {
    CalibrationOptions options;
    DetectionOptions detection;
    RefinementOptions refinement;
    int threads;
    Levels levels;
    std::vector<Vec2> positions = {};  ///< of the last update; the next one starts there
    EdgeFit edges = {};
    ExplainedShare explained = {};  ///< by the positions of the last update
    VisiblePixels visible = {};     ///< of the image it works on
    Binning blocks = {};            ///< lengths count them, given ones too

    /// Locates roughly, then refits disc, dark level and background. True once D and w rest.
    bool update(ImageModel& model, const Image& counts) {
        DetectionOptions quick = detection;
        quick.goal = SearchGoal::most_spheres;
        RefinementOptions rough = refinement;
        rough.tolerance = std::max(refinement.tolerance, 0.02);
        rough.max_sweeps = std::min(refinement.max_sweeps, positions.empty() ? 4 : 2);
        const Image darkness = model.darkness(counts);
        Locator locator(counts.width(), counts.height(), model.disc, threads);
        locator.set_visible(visible);
        Located scene = locator.locate(darkness, quick, rough, positions);
        model.noise = scene.noise;
        model.residual_rms = scene.residual_rms;
        positions = std::move(scene.fitted);
        const double clear = model.background(counts.width() / 2.0, counts.height() / 2.0);
        const double noise = levels.noise / std::max(std::abs(clear - model.dark_level), 1e-6);
        explained = explained_share(darkness, visible, scene.residual_rms, noise, model.disc,
                                    positions.size());
        const DiscProfile before = model.disc;
        fit_image(model, counts);
        return std::abs(model.disc.diameter - before.diameter) < 0.03 &&
               std::abs(model.disc.edge_width - before.edge_width) < 0.03;
    }

    /// Searches with the chosen model for every sphere, and refits the image on them; the disc that
    /// leaves less of the frame stays. Most spheres are enough where the model leaves little but
    /// noise. Whether it did.
    bool complete(ImageModel& model, const Image& counts, RunPlan& plan) {
        const char* const saved = "one search of one frame";
        const double left = std::pow(model.noise / std::max(model.residual_rms, 1e-9), 2);
        if (options.diameter && options.edge_width) {
            plan.skip("diameter and edge width of all spheres", "given", saved);
            return false;
        }
        if (1 - left < kLittleMisfit) {
            // Where the discs are wrong, what they leave looks like noise.
            plan.skip(
                "diameter and edge width of all spheres",
                explained.signal < kGoodOfAll
                    ? fmt::format("the discs explain {:.0f} % of the frame, too little",
                                  100 * std::max(0.0, explained.signal))
                    : fmt::format("{:.0f} % of the residual is noise", 100 * std::min(1.0, left)),
                saved);
            return false;
        }
        DetectionOptions whole = detection;
        whole.cores = CoreSearch::this_frame;
        Locator locator(counts.width(), counts.height(),
                        {model.disc, *model.overlap, model.correction}, threads);
        locator.set_visible(visible);
        locator.expect_misfit(model.residual_rms);
        const std::size_t before = positions.size();
        const ImageModel chosen = model;
        Located scene = locator.locate(model.darkness(counts), whole, refinement, positions);
        positions = std::move(scene.fitted);
        model.residual_rms = scene.residual_rms;
        fit_image(model, counts);
        Locator again(counts.width(), counts.height(),
                      {model.disc, *model.overlap, model.correction}, threads);
        again.set_visible(visible);
        again.expect_misfit(model.residual_rms);
        whole.cores = CoreSearch::never;
        Located refitted = again.locate(model.darkness(counts), whole, refinement, positions);
        const auto contrast = [&](const ImageModel& m) {
            return m.background(counts.width() / 2.0, counts.height() / 2.0) - m.dark_level;
        };
        const bool is_better =
            refitted.residual_rms * contrast(model) < scene.residual_rms * contrast(chosen);
        plan.run("diameter and edge width of all spheres",
                 fmt::format(
                     "{} spheres after {}: D = {:.2f} px, w = {:.2f} px leave {:.4f} of the "
                     "contrast, D = {:.2f} px, w = {:.2f} px {:.4f}",
                     positions.size(), before, in_pixels(model).diameter,
                     in_pixels(model).edge_width, refitted.residual_rms, in_pixels(chosen).diameter,
                     in_pixels(chosen).edge_width, scene.residual_rms));
        if (is_better) {
            model.residual_rms = refitted.residual_rms;
            model.noise = refitted.noise;
            positions = std::move(refitted.fitted);
        } else {
            model = chosen;
            model.residual_rms = scene.residual_rms;
            model.noise = scene.noise;
        }
        return true;
    }

    /// Disc, dark level and background in turn, positions fixed.
    void fit_image(ImageModel& model, const Image& counts) {
        for (int round = 0; round < kImageRounds; ++round) {
            edges = fit_exposed_edges(model.darkness(counts), positions, model.disc, visible);
            if (edges.pixels == 0 || !edges.converged) return;
            const DiscProfile before = model.disc;
            if (!options.diameter) model.disc.diameter = edges.disc.diameter;
            if (!options.edge_width) model.disc.edge_width = edges.disc.edge_width;
            // The core is darker than the clear background by amplitude, both as the edges see
            // them.
            const double clear = model.background(counts.width() / 2.0, counts.height() / 2.0);
            model.dark_level =
                clear - (edges.offset + edges.amplitude) * (clear - model.dark_level);
            PaddedImage transmission =
                clear_transmission(counts.width(), counts.height(), model.disc);
            place_discs(transmission, positions, model.disc);
            visible.hide_others(transmission, 0.0F);
            model.background =
                background_between_spheres(counts, transmission, model.dark_level, model.background,
                                           levels.high - levels.low, options.uniform_tolerance);
            if (std::abs(model.disc.diameter - before.diameter) < 0.01 &&
                std::abs(model.disc.edge_width - before.edge_width) < 0.01) {
                return;
            }
        }
    }
};

/// One first guess, improved on the most dilute part of the frame.
struct Trial {
    Polarity polarity;
    ImageModel model;  ///< of the image in which spheres are dark, with what the part leaves
    Fitter fitter;
    bool is_whole;  ///< the part was all of the frame
    SizeCandidate candidate = {};
};

Trial try_guess(const Image& work, const FirstGuess& guess, Fitter fitter) {
    ImageModel model;
    model.binning = fitter.blocks;
    model.background = guess.background;
    model.dark_level = guess.dark_level;
    model.disc.shape = fitter.options.profile.shape;
    model.disc.diameter = fitter.options.diameter.value_or(2 * guess.size.radius);
    model.disc.edge_width = fitter.options.edge_width.value_or(
        std::clamp(rough_edge_width(model.darkness(work), fitter.visible), kNarrowestFirstEdge,
                   std::max(kNarrowestFirstEdge, kWidestFirstEdge * model.disc.diameter)));
    const VisiblePixels visible = fitter.visible;
    const Patch patch = clearest_patch(work, model, visible);
    const bool is_whole = patch.image.size() == work.size();
    // The background of a part is taken as part of the whole.
    ImageModel local = model;
    local.background = model.background.shifted(patch.x, patch.y);
    fitter.visible = visible.part(patch.x, patch.y, patch.image.width(), patch.image.height());
    for (int round = 0; round < (is_whole ? kFrameRounds : kRounds); ++round) {
        const bool settled = fitter.update(local, patch.image);
        if (settled) break;
    }
    SizeCandidate candidate{.polarity = guess.polarity,
                            .diameter = in_pixels(local).diameter,
                            .edge_width = in_pixels(local).edge_width,
                            .spheres = static_cast<std::int64_t>(fitter.positions.size()),
                            .explained = fitter.explained,
                            .position = fitter.positions,
                            .x = patch.x * fitter.blocks.factor,
                            .y = patch.y * fitter.blocks.factor,
                            .width = patch.image.width() * fitter.blocks.factor,
                            .height = patch.image.height() * fitter.blocks.factor};
    for (Vec2& p : candidate.position) {
        p += Vec2{static_cast<double>(patch.x), static_cast<double>(patch.y)};
        p = fitter.blocks.in_frame(p);
    }
    if (is_whole) return {guess.polarity, local, fitter, true, std::move(candidate)};
    model.disc = local.disc;
    model.dark_level = local.dark_level;
    model.noise = local.noise;
    model.residual_rms = local.residual_rms;
    return {guess.polarity, model, fitter, false, std::move(candidate)};
}

/// Whether blocks tell as much as pixels: a first fit leaves clearly more than noise, and edges are
/// not too wide for the few blocks.
bool are_enough(const BinningUse& use, const ImageModel& model) {
    if (!use.widest_edge) return true;
    const double most = (1 + kMisfitForBlocks * kMisfitForBlocks) * model.noise * model.noise;
    return model.residual_rms * model.residual_rms > most &&
           in_pixels(model).edge_width <= *use.widest_edge;
}

/// What a frame is calibrated on: its pixels, or blocks of them.
struct View {
    Image counts;
    Fitter fitter;
};

View view_by(Binning blocks, const Image& counts, Fitter fitter) {
    if (blocks.is_none()) return {counts, std::move(fitter)};
    CalibrationOptions& options = fitter.options;
    if (options.diameter) *options.diameter /= blocks.factor;
    if (options.edge_width) options.edge_width = blocks.edge_in_blocks(*options.edge_width);
    fitter.detection = in_blocks(fitter.detection, blocks);
    fitter.refinement = in_blocks(fitter.refinement, blocks);
    fitter.visible = fitter.visible.blocks(blocks.factor);
    fitter.blocks = blocks;
    Image binned = blocks.binned(counts);
    fitter.levels = levels_of(binned, fitter.visible);
    return {std::move(binned), std::move(fitter)};
}

/// What the user can say that settles it.
constexpr const char* kGiveThem =
    "give calibrate.disc-diameter, calibrate.polarity, or both; tune shows the candidates";

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

/// First guesses tried in turn, until one explains the image beyond doubt.
struct Weighing {
    std::vector<Trial> trials;
    std::vector<SizeCandidate> candidates;  ///< one of each trial
    std::size_t guesses = 0;                ///< that there were
};

Weighing weigh(const Image& counts, const Fitter& fitter) {
    const CalibrationOptions& options = fitter.options;
    const std::vector<FirstGuess> guesses = first_guesses(
        counts, fitter.levels, options.polarity, options.uniform_tolerance, fitter.visible);
    Weighing all;
    all.guesses = guesses.size();
    std::optional<Polarity> tried_given;
    for (const FirstGuess& guess : guesses) {
        if (!options.diameter && guess.size.radius <= 0) continue;
        // With a diameter given, guesses of one polarity are all alike.
        if (options.diameter && tried_given == guess.polarity) continue;
        tried_given = guess.polarity;
        all.trials.push_back(try_guess(
            guess.polarity == Polarity::bright ? turned_round(counts) : counts, guess, fitter));
        all.candidates.push_back(all.trials.back().candidate);
        const ExplainedShare& explained = all.trials.back().fitter.explained;
        if (explained.signal > kGood && explained.all > kGoodOfAll &&
            explained.support > kResolved) {
            break;
        }
    }
    return all;
}

/// Where what was given explains little, what the frame says of itself is weighed too and added to
/// the candidates. Warns where that explains it better.
void weigh_unprompted(const Image& counts, Fitter fitter, const SizeCandidate& given,
                      std::vector<SizeCandidate>& weighed, RunPlan& plan) {
    fitter.options.diameter.reset();
    fitter.options.edge_width.reset();
    fitter.options.polarity = PolarityChoice::automatic;
    const Weighing all = weigh(counts, fitter);
    for (const SizeCandidate& found : all.candidates) {
        // What was given may have been guessed already.
        const bool is_known = std::ranges::any_of(weighed, [&](const SizeCandidate& known) {
            return known.polarity == found.polarity && known.diameter == found.diameter;
        });
        if (!is_known) weighed.push_back(found);
    }
    if (const std::optional<SizeCandidate> better = better_than(given, weighed)) {
        plan.warn(advice_on_size(given, *better));
    }
}

/// The trial that explains the image beyond doubt, or else the one that explains most of it,
/// charged for its coordinates; none if that is not enough, or two do it about as well. All that
/// were tried are left in `weighed`.
std::optional<Trial> best_trial(const Image& counts, const CalibrationOptions& options,
                                const Fitter& fitter, RunPlan& plan,
                                std::vector<SizeCandidate>& weighed) {
    Weighing all = weigh(counts, fitter);
    weighed = all.candidates;
    const SizeChoice choice = choose_size(weighed);
    if (!choice.best) {
        plan.warn(fmt::format("no disc-shaped objects found; if there are spheres, {}", kGiveThem));
        return std::nullopt;
    }
    Trial& best = all.trials[*choice.best];
    const bool is_prompted = options.diameter || options.polarity != PolarityChoice::automatic;
    const std::string judged = in_words(weighed);
    if (!choice.explains_enough && is_prompted) {
        weigh_unprompted(counts, fitter, best.candidate, weighed, plan);
    }
    if (!options.diameter && !choice.explains_enough) {
        plan.warn(
            fmt::format("no spheres of one size: {}; at least {:.0f} % are expected. If there are "
                        "spheres, {}",
                        judged, 100 * kLeastExplained, kGiveThem));
        return std::nullopt;
    }
    const bool is_given = options.diameter && options.polarity != PolarityChoice::automatic;
    if (choice.rival && !is_given) {
        plan.warn(fmt::format("two kinds of spheres explain the image about as well: {}; {}",
                              in_words(weighed), kGiveThem));
        return std::nullopt;
    }
    if (options.polarity == PolarityChoice::automatic || !options.diameter) {
        plan.run("size and polarity",
                 fmt::format("{} spheres: of the variance of the image {}; {} of {} first guesses "
                             "tried",
                             best.polarity == Polarity::dark ? "dark" : "bright", judged,
                             all.trials.size(), all.guesses));
    }
    if (options.polarity != PolarityChoice::automatic) {
        plan.skip("polarity", "given", "one distance transform");
    }
    return std::move(best);
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
    const Fitter by_pixels{.options = options,
                           .detection = detection,
                           .refinement = refinement,
                           .threads = threads,
                           .levels = levels,
                           .visible = visible};
    View view = view_by({options.binning.factor}, counts, by_pixels);
    RunPlan attempt;
    std::optional<Trial> best = best_trial(view.counts, options, view.fitter, attempt, candidates);
    const bool is_done =
        best ? are_enough(options.binning, best->model) : !options.binning.widest_edge;
    if (options.binning.factor > 1 && !is_done) {
        view = view_by({}, counts, by_pixels);
        best = best_trial(view.counts, options, view.fitter, plan, candidates);
    } else {
        plan.take(attempt);
    }
    if (!best) return std::nullopt;

    // From here on in terms of dark spheres; the sign is undone at the end.
    const bool bright = best->polarity == Polarity::bright;
    const Image work = bright ? turned_round(view.counts) : std::move(view.counts);
    ImageModel model = best->model;
    Fitter fitter = best->fitter;
    if (!best->is_whole) {
        fitter.visible = view.fitter.visible;
        fitter.positions.clear();
        for (int round = 0; round < kFrameRounds; ++round) {
            const bool settled = fitter.update(model, work);
            if (settled) break;
        }
    }
    const double contrast =
        model.background(0.5 * work.width(), 0.5 * work.height()) - model.dark_level;
    const double misfit = std::sqrt(std::max(
        0.0, std::pow(model.residual_rms, 2) - std::pow(fitter.levels.noise / contrast, 2)));
    if (!options.diameter && model.residual_rms > kMostLeft && misfit > kMostMisfit &&
        fitter.levels.high - fitter.levels.low < kTellsSize * fitter.levels.noise) {
        plan.warn(fmt::format(
            "too noisy to tell the size of the spheres: the noise is {:.2f} of the span of the "
            "image, discs of D = {:.1f} px leave {:.2f} of the contrast; give "
            "calibrate.disc-diameter",
            fitter.levels.noise / (fitter.levels.high - fitter.levels.low),
            in_pixels(model).diameter, model.residual_rms));
        return std::nullopt;
    }
    const EdgeFit& edges = fitter.edges;
    if (edges.pixels == 0) {
        plan.warn("no exposed edges to measure diameter and edge width on; first guesses kept");
    } else if (!edges.converged) {
        plan.warn(fmt::format(
            "the fit of diameter and edge width to exposed edges did not converge; D = {:.2f} px "
            "and w = {:.2f} px are those before it; both can be given (calibrate.disc-diameter, "
            "calibrate.edge-width)",
            in_pixels(model).diameter, in_pixels(model).edge_width));
    }
    plan.run("diameter and edge width",
             options.diameter && options.edge_width
                 ? std::string("given")
                 : fmt::format("D = {:.2f} px, w = {:.2f} px from {} {} of exposed edges",
                               in_pixels(model).diameter, in_pixels(model).edge_width, edges.pixels,
                               fitter.blocks.is_none() ? "pixels" : "blocks"));
    if (model.background.is_uniform()) {
        plan.skip("background surface",
                  fmt::format("illumination uniform to {:.1f} % of the contrast",
                              100 * options.uniform_tolerance),
                  "one polynomial a pixel");
    } else {
        plan.run("background surface", "illumination is uneven");
    }
    choose_model(work, fitter.positions, fitter.options, fitter.detection, fitter.refinement,
                 threads, fitter.visible, model, plan);
    const bool is_complete = fitter.complete(model, work, plan);
    if (bright) {
        model.background = model.background.negated();
        model.dark_level = -model.dark_level;
        model.polarity = Polarity::bright;
    }
    return Calibration{std::move(model), std::move(fitter.positions), is_complete};
}

}  // namespace grainfield::tracking
