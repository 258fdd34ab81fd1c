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
constexpr int kRoundsBetween = 2;
constexpr int kLastRounds = 4;
constexpr int kOpticsSearches = 3;
constexpr double kUnusual = 2;       // medians of the residual: a sphere is in doubt
constexpr double kSameSphere = 0.3;  // [a]

/// Moves a sphere in doubt back to the disc that it began as, if no other stands there; the way
/// back enters its error.
void stand_back(const PointGrid& discs, double range, std::vector<char>& is_taken, Vec2& position,
                Vec2& error) {
    const Vec2 fitted = position;
    double nearest = range * range;
    std::size_t chosen = is_taken.size();
    discs.near(fitted, range, [&](std::uint32_t j, Vec2 disc) {
        const double squared = squared_norm(disc - fitted);
        if (squared >= nearest || is_taken[j] != 0) return;
        nearest = squared;
        position = disc;
        chosen = j;
    });
    if (chosen < is_taken.size()) is_taken[chosen] = 1;
    error = {std::hypot(error.x, position.x - fitted.x),
             std::hypot(error.y, position.y - fitted.y)};
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
    SynthesisFit fit(brightness, ceiling, diameter, threads);
    fit.start(spheres, optics);
    result.residual_before = fit.rms();
    SynthesisLimits limits{.height = options.height, .most_rounds = kRoundsBetween};
    const auto refine = [&](int rounds, bool with_optics) {
        limits.most_rounds = rounds;
        result.rounds += fit.refine(limits);
        if (with_optics && !start.are_optics_known) fit.fit_optics();
    };
    refine(kRoundsBetween, true);
    refine(kRoundsBetween, true);
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
        refine(kRoundsBetween, search < kOpticsSearches);
    }
    refine(kLastRounds, true);
    refine(1, false);

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
    std::vector<char> is_taken(start.position.size(), 0);
    for (std::size_t i = 0; i < fit.spheres().size(); ++i) {
        const Point3& p = fit.spheres()[i];
        result.position.push_back(
            {static_cast<double>(p.x) * diameter, static_cast<double>(p.y) * diameter});
        result.z.push_back(static_cast<double>(p.z));
        result.error.push_back({errors[i].x * diameter, errors[i].y * diameter});
        result.z_error.push_back(errors[i].z);
        result.residual.push_back(errors[i].residual);
        if (!(errors[i].residual > kUnusual * usual)) continue;
        ++result.doubtful;
        stand_back(discs, kSameSphere * diameter, is_taken, result.position.back(),
                   result.error.back());
        result.z.back() = 0.5 * top;
        result.z_error.back() = std::max(result.z_error.back(), top / std::sqrt(12.0));
    }
    return result;
}

}  // namespace grainfield::tracking
