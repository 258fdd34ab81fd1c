#include "tracking/calibrate/calibration.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tracking/calibrate/background.h"
#include "tracking/calibrate/edge_fit.h"
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
/// Discs of any size explain up to 0.73 of smooth random textures, those of sharp images over 0.9.
constexpr double kLeastExplained = 0.8;
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

/// Share of the variance of an image that a model explains, 1 − misfit/variance; as it is, and
/// after the white noise was taken from both.
struct Explained {
    double all = 0;
    double signal = 0;
};

Explained explained_share(const Image& darkness, const VisiblePixels& visible, double residual_rms,
                          double noise) {
    double sum = 0;
    double squares = 0;
    double n = 0;
    for (int y = 0; y < darkness.height(); ++y) {
        for (int x = 0; x < darkness.width(); ++x) {
            if (!visible(x, y)) continue;
            const auto v = static_cast<double>(darkness(x, y));
            sum += v;
            squares += v * v;
            n += 1;
        }
    }
    const double variance = squares / n - (sum / n) * (sum / n);
    const double misfit = residual_rms * residual_rms;
    const double white = noise * noise;
    Explained share;
    if (variance > 0) share.all = 1 - misfit / variance;
    if (variance > white) share.signal = 1 - std::max(0.0, misfit - white) / (variance - white);
    return share;
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
    Explained explained = {};    ///< by the positions of the last update
    VisiblePixels visible = {};  ///< of the image it works on

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
        explained = explained_share(darkness, visible, scene.residual_rms, noise);
        const DiscProfile before = model.disc;
        fit_image(model, counts);
        return std::abs(model.disc.diameter - before.diameter) < 0.03 &&
               std::abs(model.disc.edge_width - before.edge_width) < 0.03;
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
    ImageModel model;  ///< of the image in which spheres are dark
    Fitter fitter;
    bool is_whole;  ///< the part was all of the frame
};

Trial try_guess(const Image& work, const FirstGuess& guess, Fitter fitter) {
    ImageModel model;
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
    if (is_whole) return {guess.polarity, local, fitter, true};
    model.disc = local.disc;
    model.dark_level = local.dark_level;
    return {guess.polarity, model, fitter, false};
}

/// The first guess that explains the image, or else the one that explains most of it.
std::optional<Trial> best_trial(const Image& counts, const CalibrationOptions& options,
                                const Fitter& fitter, RunPlan& plan) {
    const std::vector<FirstGuess> guesses = first_guesses(
        counts, fitter.levels, options.polarity, options.uniform_tolerance, fitter.visible);
    std::optional<Trial> best;
    std::optional<Polarity> tried_given;
    int tried = 0;
    for (const FirstGuess& guess : guesses) {
        if (!options.diameter && guess.size.radius <= 0) continue;
        // With a diameter given, guesses of one polarity are all alike.
        if (options.diameter && tried_given == guess.polarity) continue;
        tried_given = guess.polarity;
        ++tried;
        Trial trial = try_guess(guess.polarity == Polarity::bright ? turned_round(counts) : counts,
                                guess, fitter);
        if (!best || trial.fitter.explained.all > best->fitter.explained.all)
            best = std::move(trial);
        const Explained& explained = best->fitter.explained;
        if (explained.signal > kGood && explained.all > kGoodOfAll) break;
    }
    if (!best) {
        plan.warn(
            "no disc-shaped objects found; if there are spheres, their diameter is needed "
            "(calibrate.disc-diameter)");
        return std::nullopt;
    }
    const double percent = 100 * best->fitter.explained.signal;
    if (!options.diameter && best->fitter.explained.signal < kLeastExplained) {
        plan.warn(fmt::format(
            "no spheres of one size: the best discs, D = {:.1f} px, explain {:.0f} % of the "
            "image; if there are spheres, their diameter and polarity are needed "
            "(calibrate.disc-diameter, "
            "calibrate.polarity)",
            best->model.disc.diameter, std::max(0.0, percent)));
        return std::nullopt;
    }
    if (options.polarity == PolarityChoice::automatic) {
        plan.run("polarity",
                 fmt::format("{} spheres: discs of D = {:.1f} px explain {:.1f} % of the image; {} "
                             "of {} first guesses tried",
                             best->polarity == Polarity::dark ? "dark" : "bright",
                             best->model.disc.diameter, percent, tried, guesses.size()));
    } else {
        plan.skip("polarity", "given", "one distance transform");
    }
    return best;
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
                                     RunPlan& plan, const VisiblePixels& visible) {
    const Levels levels = levels_of(counts, visible);
    if (const std::string reason = blank_reason(levels); !reason.empty()) {
        plan.warn(reason);
        return std::nullopt;
    }
    const std::optional<Trial> best = best_trial(counts, options,
                                                 {.options = options,
                                                  .detection = detection,
                                                  .refinement = refinement,
                                                  .threads = threads,
                                                  .levels = levels,
                                                  .visible = visible},
                                                 plan);
    if (!best) return std::nullopt;

    // From here on in terms of dark spheres; the sign is undone at the end.
    const bool bright = best->polarity == Polarity::bright;
    const Image work = bright ? turned_round(counts) : counts;
    ImageModel model = best->model;
    Fitter fitter = best->fitter;
    if (!best->is_whole) {
        fitter.visible = visible;
        fitter.positions.clear();
        for (int round = 0; round < kFrameRounds; ++round) {
            const bool settled = fitter.update(model, work);
            if (settled) break;
        }
    }
    const EdgeFit& edges = fitter.edges;
    if (edges.pixels == 0) {
        plan.warn("no exposed edges to measure diameter and edge width on; first guesses kept");
    } else if (!edges.converged) {
        plan.warn(fmt::format(
            "the fit of diameter and edge width to exposed edges did not converge; D = {:.2f} px "
            "and w = {:.2f} px are those before it; both can be given (calibrate.disc-diameter, "
            "calibrate.edge-width)",
            model.disc.diameter, model.disc.edge_width));
    }
    plan.run("diameter and edge width",
             options.diameter && options.edge_width
                 ? std::string("given")
                 : fmt::format("D = {:.2f} px, w = {:.2f} px from {} pixels of exposed edges",
                               model.disc.diameter, model.disc.edge_width, edges.pixels));
    if (model.background.is_uniform()) {
        plan.skip("background surface",
                  fmt::format("illumination uniform to {:.1f} % of the contrast",
                              100 * options.uniform_tolerance),
                  "one polynomial a pixel");
    } else {
        plan.run("background surface", "illumination is uneven");
    }
    choose_model(work, fitter.positions, options, detection, refinement, threads, visible, model,
                 plan);
    if (bright) {
        model.background = model.background.negated();
        model.dark_level = -model.dark_level;
        model.polarity = Polarity::bright;
    }
    return Calibration{std::move(model), std::move(fitter.positions)};
}

}  // namespace grainfield::tracking
