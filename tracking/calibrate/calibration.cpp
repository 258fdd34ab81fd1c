#include "tracking/calibrate/calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tracking/calibrate/coarse_size.h"
#include "tracking/calibrate/edge_fit.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

/// An edge as sharp as a lens makes it, relative to D; the fit starts here.
constexpr double kFirstEdgeWidth = 0.12;
/// Contrast in units of the noise below which a frame is blank.
constexpr double kBlank = 7;
constexpr int kRounds = 4;
constexpr int kFrameRounds = 2;
constexpr int kImageRounds = 6;

struct Levels {
    double low,
        high;      ///< 0.5 % and 99.5 % quantiles; those of few spheres are the extremes [counts]
    double noise;  ///< RMS of what varies from pixel to pixel [counts]
};

/// From every fourth row and third column: a percent of accuracy is plenty.
Levels levels_of(const Image& counts) {
    constexpr int kRowStep = 4;
    constexpr int kColumnStep = 3;
    std::vector<float> sample;
    double sum = 0;
    double n = 0;
    float darkest = std::numeric_limits<float>::max();
    float brightest = std::numeric_limits<float>::lowest();
    for (int y = 1; y + 1 < counts.height(); y += kRowStep) {
        const float* a = counts.row(y - 1);
        const float* b = counts.row(y);
        const float* c = counts.row(y + 1);
        for (int x = 1; x + 1 < counts.width(); x += kColumnStep) {
            sample.push_back(b[x]);
            const float mean = (a[x - 1] + a[x] + a[x + 1] + b[x - 1] + b[x] + b[x + 1] + c[x - 1] +
                                c[x] + c[x + 1]) /
                               9;
            darkest = std::min(darkest, mean);
            brightest = std::max(brightest, mean);
            // Second differences along both axes cancel smooth structure; for white noise their RMS
            // is 6 σ.
            const float d = a[x - 1] - 2 * a[x] + a[x + 1] - 2 * (b[x - 1] - 2 * b[x] + b[x + 1]) +
                            c[x - 1] - 2 * c[x] + c[x + 1];
            sum += static_cast<double>(d) * static_cast<double>(d);
            n += 1;
        }
    }
    if (sample.empty()) return {0, 0, 0};
    const auto quantile = [&](double q) {
        const auto rank = static_cast<std::ptrdiff_t>(q * static_cast<double>(sample.size() - 1));
        std::nth_element(sample.begin(), sample.begin() + rank, sample.end());
        return static_cast<double>(sample[static_cast<std::size_t>(rank)]);
    };
    const double noise = std::sqrt(sum / n) / 6;
    const double low = quantile(0.005);
    const double high = quantile(0.995);
    // A few spheres cover less than the quantiles see. Means of nine pixels scatter by σ/3, those
    // of pure noise span 3 σ in a million.
    if (high - low < kBlank * noise) {
        return {std::min(low, static_cast<double>(darkest)),
                std::max(high, static_cast<double>(brightest)), noise};
    }
    return {low, high, noise};
}

std::string blank_reason(const Levels& levels) {
    const double contrast = levels.high - levels.low;
    if (!(contrast >= 2)) {
        return fmt::format(
            "no contrast: 99 % of the pixels lie between {:.0f} and {:.0f} counts "
            "(black, saturated or empty frame)",
            levels.low, levels.high);
    }
    // 99 % of white noise lies within ±2.6 σ: a contrast of 5.2 σ is what noise alone gives.
    if (contrast < kBlank * levels.noise) {
        return fmt::format("nothing above the noise: contrast {:.1f} counts, noise {:.1f} counts",
                           contrast, levels.noise);
    }
    return {};
}

Image flipped(const Image& counts) {
    Image image = counts;
    for (float& v : image.pixels()) v = -v;
    return image;
}

/// One polarity's first guess, on an image in which spheres are dark.
struct FirstGuess {
    BackgroundSurface background;
    double dark_level = 0;
    CoarseSize size;
};

FirstGuess first_guess(const Image& counts, double dark_level, double contrast, double tolerance) {
    FirstGuess guess;
    guess.background = upper_envelope(counts, contrast, tolerance);
    guess.dark_level = dark_level;
    Image mask(counts.width(), counts.height());
    std::vector<float> background(static_cast<std::size_t>(counts.width()));
    for (int y = 0; y < counts.height(); ++y) {
        guess.background.row(y, counts.width(), background.data());
        for (int x = 0; x < counts.width(); ++x) {
            const float middle =
                (background[static_cast<std::size_t>(x)] + static_cast<float>(dark_level)) / 2;
            mask(x, y) = counts(x, y) < middle ? 1.0F : 0.0F;
        }
    }
    guess.size = coarse_size(mask);
    return guess;
}

struct Start {
    Polarity polarity;
    FirstGuess guess;
};

std::optional<Start> choose_polarity(const Image& counts, const Levels& levels,
                                     const CalibrationOptions& options, RunPlan& plan) {
    const double contrast = levels.high - levels.low;
    std::optional<FirstGuess> dark;
    std::optional<FirstGuess> bright;
    if (options.polarity != PolarityChoice::bright) {
        dark = first_guess(counts, levels.low, contrast, options.uniform_tolerance);
    }
    if (options.polarity != PolarityChoice::dark) {
        bright = first_guess(flipped(counts), -levels.high, contrast, options.uniform_tolerance);
    }
    if (dark && bright) {
        const bool is_dark = dark->size.coverage >= bright->size.coverage;
        plan.run(
            "polarity",
            fmt::format("{} spheres: discs of one size cover {:.0f} % of the dark area, {:.0f} % "
                        "of the bright area",
                        is_dark ? "dark" : "bright", 100 * dark->size.coverage,
                        100 * bright->size.coverage));
        (is_dark ? bright : dark).reset();
    } else {
        plan.skip("polarity", "given", "one distance transform");
    }
    Start start{dark ? Polarity::dark : Polarity::bright, dark ? *dark : *bright};
    if (!options.diameter && start.guess.size.radius <= 0) {
        plan.warn("no disc-shaped objects found; give --diameter if there are spheres");
        return std::nullopt;
    }
    return start;
}

struct Patch {
    Image image;
    int x = 0, y = 0;  ///< its first pixel in the frame
};

/// The square of about 30 diameters that is brightest on average, thus most dilute; the whole frame
/// if it is not much larger.
Patch clearest_patch(const Image& counts, const ImageModel& model) {
    const int side = std::max(256, static_cast<int>(30 * model.disc.diameter));
    if (counts.width() < 3 * side / 2 || counts.height() < 3 * side / 2) return {counts, 0, 0};
    const Image darkness = model.darkness(counts);
    double best = 0;
    Patch patch;
    for (int y = 0; y + side <= counts.height(); y += side / 4) {
        for (int x = 0; x + side <= counts.width(); x += side / 4) {
            double sum = 0;
            for (int row = y; row < y + side; row += 2) {
                for (int column = x; column < x + side; column += 2) {
                    sum += static_cast<double>(darkness(column, row));
                }
            }
            // A patch without spheres teaches nothing.
            const double mean = sum / (0.25 * side * side);
            const double score = mean < 0.1 ? 1 - mean : mean;
            if (best == 0 || score < best) {
                best = score;
                patch.x = x;
                patch.y = y;
            }
        }
    }
    patch.image = Image(side, side);
    for (int y = 0; y < side; ++y) {
        std::copy_n(counts.row(patch.y + y) + patch.x, side, patch.image.row(y));
    }
    return patch;
}

/// Improves a model on an image, step by step.
struct Fitter {
    const CalibrationOptions& options;
    DetectionOptions detection;
    RefinementOptions refinement;
    int threads;
    double contrast;
    std::vector<Vec2> positions = {};  ///< of the last update; the next one starts there
    EdgeFit edges = {};

    /// Locates roughly, then refits disc, dark level and background. True once D and w rest.
    bool update(ImageModel& model, const Image& counts) {
        DetectionOptions quick = detection;
        quick.max_passes = 1;
        RefinementOptions rough = refinement;
        rough.tolerance = std::max(refinement.tolerance, 0.02);
        rough.max_sweeps = std::min(refinement.max_sweeps, positions.empty() ? 4 : 2);
        const Image darkness = model.darkness(counts);
        Locator locator(counts.width(), counts.height(), model.disc, threads);
        Located scene = locator.locate(darkness, quick, rough, positions);
        model.noise = scene.noise;
        model.residual_rms = scene.residual_rms;
        positions = std::move(scene.fitted);
        const DiscProfile before = model.disc;
        fit_image(model, counts);
        return std::abs(model.disc.diameter - before.diameter) < 0.03 &&
               std::abs(model.disc.edge_width - before.edge_width) < 0.03;
    }

    /// Disc, dark level and background in turn, positions fixed.
    void fit_image(ImageModel& model, const Image& counts) {
        for (int round = 0; round < kImageRounds; ++round) {
            edges = fit_exposed_edges(model.darkness(counts), positions, model.disc);
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
            for (const Vec2 p : positions) place_disc(transmission, p, model.disc);
            model.background =
                background_between_spheres(counts, transmission, model.dark_level, model.background,
                                           contrast, options.uniform_tolerance);
            if (std::abs(model.disc.diameter - before.diameter) < 0.01 &&
                std::abs(model.disc.edge_width - before.edge_width) < 0.01) {
                return;
            }
        }
    }
};

}  // namespace

OptionTable describe(CalibrationOptions& options) {
    OptionTable table("calibrate");
    table.number("diameter", options.diameter, "px", {2, 2000}, "apparent diameter of a sphere");
    table.number("edge-width", options.edge_width, "px", {0.05, 200}, "width w of its tanh edge");
    table.choice("polarity", options.polarity,
                 {{"auto", PolarityChoice::automatic},
                  {"dark", PolarityChoice::dark},
                  {"bright", PolarityChoice::bright}},
                 "spheres darker or brighter than the background");
    table.number("uniform-tolerance", options.uniform_tolerance, "-", {0, 1},
                 "variation of the background, relative to the contrast, that is ignored");
    return table;
}

std::string blank_reason(const Image& counts) {
    return blank_reason(levels_of(counts));
}

std::optional<Calibration> calibrate(const Image& counts, const CalibrationOptions& options,
                                     const DetectionOptions& detection,
                                     const RefinementOptions& refinement, int threads,
                                     RunPlan& plan) {
    const Levels levels = levels_of(counts);
    const double contrast = levels.high - levels.low;
    if (const std::string reason = blank_reason(levels); !reason.empty()) {
        plan.warn(reason);
        return std::nullopt;
    }
    const std::optional<Start> start = choose_polarity(counts, levels, options, plan);
    if (!start) return std::nullopt;

    // From here on in terms of dark spheres; the sign is undone at the end.
    const bool bright = start->polarity == Polarity::bright;
    const Image work = bright ? flipped(counts) : counts;
    ImageModel model;
    model.background = start->guess.background;
    model.dark_level = start->guess.dark_level;
    model.disc.diameter = options.diameter.value_or(2 * start->guess.size.radius);
    model.disc.edge_width = options.edge_width.value_or(kFirstEdgeWidth * model.disc.diameter);

    Fitter fitter{options, detection, refinement, threads, contrast};
    const Patch patch = clearest_patch(work, model);
    if (patch.image.size() < work.size()) {
        // Size and edge from the most dilute part; its background is taken as part of the whole.
        ImageModel local = model;
        local.background = model.background.shifted(patch.x, patch.y);
        for (int round = 0; round < kRounds; ++round) {
            const bool settled = fitter.update(local, patch.image);
            if (settled) break;
        }
        model.disc = local.disc;
        model.dark_level = local.dark_level;
        fitter.positions.clear();
    }
    for (int round = 0; round < kFrameRounds; ++round) {
        const bool settled = fitter.update(model, work);
        if (settled) break;
    }
    const EdgeFit& edges = fitter.edges;
    if (edges.pixels == 0) {
        plan.warn("no exposed edges to measure diameter and edge width on; first guesses kept");
    } else if (!edges.converged) {
        plan.warn(fmt::format(
            "the fit of diameter and edge width to exposed edges did not converge; D = {:.2f} px "
            "and w = {:.2f} px are those before it; give --diameter and --edge-width",
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
    if (bright) {
        model.background = model.background.negated();
        model.dark_level = -model.dark_level;
        model.polarity = Polarity::bright;
    }
    return Calibration{std::move(model), std::move(fitter.positions)};
}

}  // namespace grainfield::tracking
