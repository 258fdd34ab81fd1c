#include "tracking/calibrate/size_trials.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "tracking/calibrate/edge_fit.h"
#include "tracking/calibrate/first_guess.h"

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
constexpr int kPartRounds = 4;  // most on a part of the frame

/// Side of the part of the frame that is looked at: so many diameters, but so many pixels at least.
struct PartSize {
    int diameters, pixels;
};
constexpr PartSize kPart{30, 256};
/// Where a crystal reaches into every part, so that no guess explains enough.
constexpr PartSize kSmallPart{15, 128};

/// What the user can say that settles it.
constexpr const char* kGiveThem =
    "give calibrate.disc-diameter, calibrate.polarity, or both; tune shows the candidates";

struct Patch {
    Image image;
    int x = 0, y = 0;  ///< its first pixel in the frame
};

int side_of(PartSize size, double diameter) {
    return std::max(size.pixels, static_cast<int>(size.diameters * diameter));
}

bool is_larger_than_a_part(const Image& counts, double diameter, PartSize size) {
    const int least = 3 * side_of(size, diameter) / 2;
    return counts.width() >= least && counts.height() >= least;
}

/// The square of that size that is brightest on average, thus most dilute; the whole frame if it is
/// not much larger. At least half of it is visible.
Patch clearest_patch(const Image& counts, const ImageModel& model, const VisiblePixels& visible,
                     PartSize size) {
    if (!is_larger_than_a_part(counts, model.disc.diameter, size)) return {counts, 0, 0};
    const int side = side_of(size, model.disc.diameter);
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

SizeTrial try_guess(const Image& work, const FirstGuess& guess, PartSize size, ModelFit fit) {
    ImageModel model;
    model.binning = fit.blocks;
    model.background = guess.background;
    model.dark_level = guess.dark_level;
    model.disc.shape = fit.options.profile.shape;
    model.disc.diameter = fit.options.diameter.value_or(2 * guess.size.radius);
    model.disc.edge_width = fit.options.edge_width.value_or(
        std::clamp(rough_edge_width(model.darkness(work), fit.visible), kNarrowestFirstEdge,
                   std::max(kNarrowestFirstEdge, kWidestFirstEdge * model.disc.diameter)));
    const VisiblePixels visible = fit.visible;
    const Patch patch = clearest_patch(work, model, visible, size);
    const bool is_whole = patch.image.size() == work.size();
    // The background of a part is taken as part of the whole.
    ImageModel local = model;
    local.background = model.background.shifted(patch.x, patch.y);
    fit.visible = visible.part(patch.x, patch.y, patch.image.width(), patch.image.height());
    fit.settle(local, patch.image, is_whole ? ModelFit::kFrameRounds : kPartRounds);
    SizeCandidate candidate{.polarity = guess.polarity,
                            .diameter = disc_in_pixels(local).diameter,
                            .edge_width = disc_in_pixels(local).edge_width,
                            .spheres = static_cast<std::int64_t>(fit.positions.size()),
                            .explained = fit.explained,
                            .position = fit.positions,
                            .x = patch.x * fit.blocks.factor,
                            .y = patch.y * fit.blocks.factor,
                            .width = patch.image.width() * fit.blocks.factor,
                            .height = patch.image.height() * fit.blocks.factor};
    for (Vec2& p : candidate.position) {
        p += Vec2{static_cast<double>(patch.x), static_cast<double>(patch.y)};
        p = fit.blocks.in_frame(p);
    }
    if (is_whole) return {guess.polarity, local, fit, true, std::move(candidate)};
    model.disc = local.disc;
    model.dark_level = local.dark_level;
    model.noise = local.noise;
    model.residual_rms = local.residual_rms;
    return {guess.polarity, model, fit, false, std::move(candidate)};
}

/// First guesses tried in turn, until one explains the image beyond doubt.
struct Weighing {
    std::vector<SizeTrial> trials;
    std::vector<SizeCandidate> candidates;  ///< one of each trial
    std::size_t guesses = 0;                ///< that there were
    bool ends_with_smaller_part = false;    ///< the last trial is of one
};

bool is_beyond_doubt(const ExplainedShare& explained) {
    return explained.signal > kGood && explained.all > kGoodOfAll && explained.support > kResolved;
}

Weighing weigh(const Image& counts, const ModelFit& fit, PartSize size) {
    const CalibrationOptions& options = fit.options;
    const std::vector<FirstGuess> guesses =
        first_guesses(counts, fit.levels, options.polarity, options.uniform_tolerance, fit.visible);
    Weighing all;
    all.guesses = guesses.size();
    std::optional<Polarity> tried_given;
    for (const FirstGuess& guess : guesses) {
        if (!options.diameter && guess.size.radius <= 0) continue;
        // With a diameter given, guesses of one polarity are all alike.
        if (options.diameter && tried_given == guess.polarity) continue;
        tried_given = guess.polarity;
        all.trials.push_back(try_guess(
            guess.polarity == Polarity::bright ? turned_round(counts) : counts, guess, size, fit));
        all.candidates.push_back(all.trials.back().candidate);
        if (is_beyond_doubt(all.trials.back().fit.explained)) break;
    }
    return all;
}

/// Where no guess explains enough of its part, one that explains a smaller part beyond doubt is
/// added. Less does not count: discs of any size explain more of a small part by chance.
void weigh_smaller_parts(const Image& counts, const ModelFit& fit, Weighing& all) {
    const bool has_parts = std::ranges::any_of(all.candidates, [&](const SizeCandidate& tried) {
        return is_larger_than_a_part(counts, tried.diameter / fit.blocks.factor, kSmallPart);
    });
    if (!has_parts) return;
    Weighing small = weigh(counts, fit, kSmallPart);
    if (small.trials.empty() || !is_beyond_doubt(small.trials.back().fit.explained)) return;
    all.trials.push_back(std::move(small.trials.back()));
    all.candidates.push_back(std::move(small.candidates.back()));
    ++all.guesses;
    all.ends_with_smaller_part = true;
}

/// Where what was given explains little, what the frame says of itself is weighed too and added to
/// the candidates. Warns where that explains it better.
void weigh_unprompted(const Image& counts, ModelFit fit, const SizeCandidate& given,
                      std::vector<SizeCandidate>& weighed, RunPlan& plan) {
    fit.options.diameter.reset();
    fit.options.edge_width.reset();
    fit.options.polarity = PolarityChoice::automatic;
    const Weighing all = weigh(counts, fit, kPart);
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

}  // namespace

std::optional<SizeTrial> best_trial(const Image& counts, const ModelFit& fit, RunPlan& plan,
                                    std::vector<SizeCandidate>& weighed) {
    const CalibrationOptions& options = fit.options;
    Weighing all = weigh(counts, fit, kPart);
    if (!options.diameter && !choose_size(all.candidates).explains_enough) {
        weigh_smaller_parts(counts, fit, all);
    }
    weighed = all.candidates;
    const SizeChoice choice = choose_size(weighed);
    if (!choice.best) {
        plan.warn(fmt::format("no disc-shaped objects found; if there are spheres, {}", kGiveThem));
        return std::nullopt;
    }
    SizeTrial& best = all.trials[*choice.best];
    const bool is_prompted = options.diameter || options.polarity != PolarityChoice::automatic;
    const std::string judged = in_words(weighed);
    if (!choice.explains_enough && is_prompted) {
        weigh_unprompted(counts, fit, best.candidate, weighed, plan);
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
    if (all.ends_with_smaller_part && *choice.best + 1 == all.trials.size()) {
        plan.warn(
            fmt::format("the size is that of a clear part of {} px. All parts twice as wide hold a "
                        "dense crystal, or what is no sphere: {}. Look at the overlay; options "
                        "region and mask leave out what is no sphere",
                        best.candidate.width, judged));
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

}  // namespace grainfield::tracking
