#include "tracking/calibrate/model_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "tracking/calibrate/background.h"
#include "tracking/refine/disc_kernel.h"

namespace grainfield::tracking {
namespace {

/// A model describes the frame where this share of the residual's variance is not noise.
constexpr double kLittleMisfit = 0.2;
/// Discs are wrong that explain less than this share of the image, noise left aside.
constexpr double kLeastSignal = 0.5;
constexpr int kImageRounds = 6;

}  // namespace

DiscProfile disc_in_pixels(const ImageModel& model) {
    return model.binning.in_frame(model.disc);
}

bool ModelFit::update(ImageModel& model, const Image& counts) {
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
    explained =
        explained_share(darkness, visible, scene.residual_rms, noise, model.disc, positions.size());
    const DiscProfile before = model.disc;
    fit_image(model, counts);
    return std::abs(model.disc.diameter - before.diameter) < 0.03 &&
           std::abs(model.disc.edge_width - before.edge_width) < 0.03;
}

bool ModelFit::complete(ImageModel& model, const Image& counts, RunPlan& plan) {
    const char* const saved = "one search of one frame";
    const double left = std::pow(model.noise / std::max(model.residual_rms, 1e-9), 2);
    if (options.diameter && options.edge_width) {
        plan.skip("diameter and edge width of all spheres", "given", saved);
        return false;
    }
    if (1 - left < kLittleMisfit) {
        // Where the discs are wrong, what they leave looks like noise.
        plan.skip("diameter and edge width of all spheres",
                  explained.signal < kLeastSignal
                      ? fmt::format("the discs explain {:.0f} % of the frame, too little",
                                    100 * std::max(0.0, explained.signal))
                      : fmt::format("{:.0f} % of the residual is noise", 100 * std::min(1.0, left)),
                  saved);
        return false;
    }
    DetectionOptions whole = detection;
    whole.cores = CoreSearch::this_frame;
    Locator locator(counts.width(), counts.height(), {model.disc, *model.overlap, model.correction},
                    threads);
    locator.set_visible(visible);
    locator.expect_misfit(model.residual_rms);
    const std::size_t before = positions.size();
    const ImageModel chosen = model;
    Located scene = locator.locate(model.darkness(counts), whole, refinement, positions);
    positions = std::move(scene.fitted);
    model.residual_rms = scene.residual_rms;
    fit_image(model, counts);
    Locator again(counts.width(), counts.height(), {model.disc, *model.overlap, model.correction},
                  threads);
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
             fmt::format("{} spheres after {}: D = {:.2f} px, w = {:.2f} px leave {:.4f} of the "
                         "contrast, D = {:.2f} px, w = {:.2f} px {:.4f}",
                         positions.size(), before, disc_in_pixels(model).diameter,
                         disc_in_pixels(model).edge_width, refitted.residual_rms,
                         disc_in_pixels(chosen).diameter, disc_in_pixels(chosen).edge_width,
                         scene.residual_rms));
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

void ModelFit::settle(ImageModel& model, const Image& counts, int rounds) {
    for (int round = 0; round < rounds; ++round) {
        if (update(model, counts)) return;
    }
}

/// Disc, dark level and background in turn, positions fixed.
void ModelFit::fit_image(ImageModel& model, const Image& counts) {
    for (int round = 0; round < kImageRounds; ++round) {
        edges = fit_exposed_edges(model.darkness(counts), positions, model.disc, visible);
        if (edges.pixels == 0 || !edges.converged) return;
        const DiscProfile before = model.disc;
        if (!options.diameter) model.disc.diameter = edges.disc.diameter;
        if (!options.edge_width) model.disc.edge_width = edges.disc.edge_width;
        // The core is darker than the clear background by amplitude, both as the edges see
        // them.
        const double clear = model.background(counts.width() / 2.0, counts.height() / 2.0);
        model.dark_level = clear - (edges.offset + edges.amplitude) * (clear - model.dark_level);
        PaddedImage transmission = clear_transmission(counts.width(), counts.height(), model.disc);
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

}  // namespace grainfield::tracking
