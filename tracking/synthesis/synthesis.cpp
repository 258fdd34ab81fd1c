#include "tracking/synthesis/synthesis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "tracking/synthesis/brightness_synthesis.h"

namespace grainfield::tracking {
namespace {

// A tanh edge of width w has the slope of a Gaussian blur of w/1.25; mirror rims widen it.
constexpr double kBlurOfEdge = 0.7;  // [w]

/// An error in the plane, whose part that goes with the height grows as that of the height does.
double with_height(double error, double by_height, double plane, double height) {
    const double more = std::max(0.0, height * height - plane * plane);
    return std::sqrt(plane * plane * error * error + more * by_height * by_height);
}

}  // namespace

OptionTable describe(SynthesisOptions& options) {
    OptionTable table("synthesis");
    table.integer("searches", options.searches, "-", {0, 100},
                  "most rounds of the search for other arrangements");
    return table;
}

Synthesis synthesise(const Image& counts, const ImageModel& model, double diameter,
                     const SynthesisStart& start, const SynthesisOptions& options, int threads) {
    Image brightness = model.darkness(counts);
    for (float& v : brightness.pixels()) v = 1 - v;
    const float brightest = *std::max_element(counts.pixels().begin(), counts.pixels().end());
    Image ceiling(counts.width(), counts.height());
    for (int y = 0; y < counts.height(); ++y) {
        for (int x = 0; x < counts.width(); ++x) {
            ceiling(x, y) = 1 - model.darkness_of(x, y)(brightest - 0.5F);
        }
    }
    const double top = options.height - 1;
    BrightnessStart begin{.spheres = {},
                          .are_heights_known = !start.z.empty(),
                          .optics = start.optics,
                          .are_optics_known = start.are_optics_known,
                          .wants_overlap_factor = !start.error_scale};
    for (std::size_t i = 0; i < start.position.size(); ++i) {
        const double z = start.z.empty() ? 0.5 * top : start.z[i];
        begin.spheres.push_back({static_cast<float>(start.position[i].x / diameter),
                                 static_cast<float>(start.position[i].y / diameter),
                                 static_cast<float>(z)});
    }
    MirrorOptics& optics = begin.optics;
    if (!start.are_optics_known) optics.blur = kBlurOfEdge * model.disc.edge_width / diameter;
    optics.middle_x = 0.5 * (counts.width() - 1) / diameter;
    optics.middle_y = 0.5 * (counts.height() - 1) / diameter;

    BrightnessSynthesis fit = synthesise_brightness(brightness, ceiling, diameter, begin,
                                                    options.height, options.searches, threads);
    Synthesis result;
    result.optics = fit.optics;
    result.optics_error = start.are_optics_known ? start.optics_error : fit.optics_error;
    result.residual_before = fit.residual_before;
    result.residual_rms = fit.residual_rms;
    result.unexplained = fit.unexplained;
    result.rounds = fit.rounds;
    result.trials = fit.trials;
    result.added = fit.added;
    result.removed = fit.removed;
    result.lifted = fit.lifted;
    result.error_scale = start.error_scale
                             ? *start.error_scale
                             : learn_error_scale(brightness, ceiling, diameter, begin, fit,
                                                 options.height, options.searches, threads);
    const std::vector<std::size_t> classes = overlap_classes(fit.spheres);
    for (std::size_t i = 0; i < fit.spheres.size(); ++i) {
        const Point3& p = fit.spheres[i];
        const Vec2 at = diameter * Vec2{static_cast<double>(p.x), static_cast<double>(p.y)};
        const SphereError& e = fit.error[i];
        const double plane = result.error_scale.plane[classes[i]];
        const double height = result.error_scale.height[classes[i]];
        // No height is less known than one anywhere between the plates.
        const double unknown = top / std::sqrt(12.0);
        result.position.push_back(at);
        result.z.push_back(static_cast<double>(p.z));
        result.error.push_back({diameter * with_height(e.x, e.x_by_z, plane, height),
                                diameter * with_height(e.y, e.y_by_z, plane, height)});
        result.z_error.push_back(std::min(unknown, height * e.z));
        result.residual.push_back(e.residual);
        if (fit.is_doubtful[i] == 0) continue;
        // What the border cuts cannot agree: the panel and the neighbours beyond are not seen.
        const double inside =
            std::min({at.x, at.y, counts.width() - 1 - at.x, counts.height() - 1 - at.y});
        result.doubtful += inside >= diameter ? 1 : 0;
        const Vec2 way = diameter * fit.way_from_disc[i];
        Vec2& error = result.error.back();
        error = {std::hypot(error.x, way.x), std::hypot(error.y, way.y)};
        result.z_error.back() = unknown;
    }
    result.residual_map = std::move(fit.residual);
    return result;
}

}  // namespace grainfield::tracking
