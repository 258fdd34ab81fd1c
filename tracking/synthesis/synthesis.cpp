#include "tracking/synthesis/synthesis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/support/parallel.h"
#include "tracking/point_grid.h"
#include "tracking/synthesis/arrangement_search.h"
#include "tracking/synthesis/sphere_errors.h"
#include "tracking/synthesis/synthesis_fit.h"

namespace grainfield::tracking {
namespace {

// A tanh edge of width w has the slope of a Gaussian blur of w/1.25; mirror rims widen it.
constexpr double kBlurOfEdge = 0.7;  // [w]
constexpr double kManyRays = 40;     // along a diameter, of the last image
constexpr int kRoundsBetween = 2;
constexpr int kLastRounds = 2;
constexpr double kUnusual = 3;       // medians of the residual: a sphere is in doubt
constexpr double kSameSphere = 0.3;  // [a]

/// Distance of a sphere in doubt from the nearest disc that it can have begun as, per axis [px].
Vec2 way_from_disc(const PointGrid& discs, double range, Vec2 fitted) {
    Vec2 way{0, 0};
    double nearest = range * range;
    discs.near(fitted, range, [&](std::uint32_t, Vec2 disc) {
        const double squared = squared_norm(disc - fitted);
        if (squared >= nearest) return;
        nearest = squared;
        way = disc - fitted;
    });
    return way;
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
    std::vector<Point3> spheres;  // as they begin
    for (std::size_t i = 0; i < start.position.size(); ++i) {
        const double z = start.z.empty() ? 0.5 * top : start.z[i];
        spheres.push_back({static_cast<float>(start.position[i].x / diameter),
                           static_cast<float>(start.position[i].y / diameter),
                           static_cast<float>(z)});
    }
    MirrorOptics optics = start.optics;
    if (!start.are_optics_known) optics.blur = kBlurOfEdge * model.disc.edge_width / diameter;
    optics.middle_x = 0.5 * (counts.width() - 1) / diameter;
    optics.middle_y = 0.5 * (counts.height() - 1) / diameter;

    Synthesis result;
    SynthesisLimits limits{.height = options.height};
    const auto refine = [&](SynthesisFit& fit, int rounds) {
        limits.most_rounds = rounds;
        result.rounds += fit.refine(limits);
    };
    SynthesisFit fit(brightness, ceiling, diameter, threads);
    const auto refine_with_optics = [&](int rounds) {
        refine(fit, rounds);
        if (!start.are_optics_known) fit.fit_optics();
    };
    {
        SynthesisFit rough(brightness, ceiling, diameter, threads, kHeightRays);
        rough.start(spheres, optics);
        result.residual_before = rough.rms();
        if (start.z.empty()) {  // else they are those of the frame before
            result.rounds += rough.find_heights(limits);
        } else {
            refine(rough, 1);
        }
        fit.start(rough.spheres(), optics);
    }
    if (!start.are_optics_known) fit.fit_optics();
    refine_with_optics(start.z.empty() ? kRoundsBetween : 1);
    for (int search = 0; search < options.searches; ++search) {
        std::vector<Point3> better;
        const ArrangementChanges changes = improve_arrangement(brightness, ceiling, fit, spheres,
                                                               diameter, limits, threads, better);
        result.trials += changes.trials;
        if (changes.lifted + changes.added + changes.removed == 0) break;
        result.added += changes.added;
        result.removed += changes.removed;
        result.lifted += changes.lifted;
        fit.start(std::move(better), fit.optics());
        refine_with_optics(kRoundsBetween);
    }
    refine(fit, 1);
    fit.sharpen(kManyRays);
    refine(fit, kLastRounds);

    result.optics = fit.optics();
    result.residual_rms = fit.rms();
    result.residual_map = fit.residual();
    const std::vector<SphereError> errors = sphere_errors(fit, limits, threads);
    std::vector<double> sorted;
    for (const SphereError& e : errors) sorted.push_back(e.residual);
    if (!sorted.empty()) {
        const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
        std::nth_element(sorted.begin(), middle, sorted.end());
    }
    const double usual = sorted.empty() ? 0 : sorted[sorted.size() / 2];
    const PointGrid discs(start.position, kSameSphere * diameter);
    for (std::size_t i = 0; i < fit.spheres().size(); ++i) {
        const Point3& p = fit.spheres()[i];
        result.position.push_back(
            {static_cast<double>(p.x) * diameter, static_cast<double>(p.y) * diameter});
        result.z.push_back(static_cast<double>(p.z));
        result.error.push_back({errors[i].x * diameter, errors[i].y * diameter});
        result.z_error.push_back(errors[i].z);
        result.residual.push_back(errors[i].residual);
        if (!(errors[i].residual > kUnusual * usual)) continue;
        // What the border cuts cannot agree: the panel and the neighbours beyond are not seen.
        const Vec2 at = result.position.back();
        const double inside =
            std::min({at.x, at.y, counts.width() - 1 - at.x, counts.height() - 1 - at.y});
        result.doubtful += inside >= diameter ? 1 : 0;
        const Vec2 way = way_from_disc(discs, kSameSphere * diameter, result.position.back());
        Vec2& error = result.error.back();
        error = {std::hypot(error.x, way.x), std::hypot(error.y, way.y)};
        result.z_error.back() = std::max(result.z_error.back(), top / std::sqrt(12.0));
    }
    return result;
}

}  // namespace grainfield::tracking
