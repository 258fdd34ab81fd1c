#include "tracking/synthesis/brightness_synthesis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "tracking/point_grid.h"
#include "tracking/synthesis/arrangement_search.h"
#include "tracking/synthesis/frame_light.h"
#include "tracking/synthesis/synthesis_fit.h"

namespace grainfield::tracking {
namespace {

constexpr double kManyRays = 40;  // along a diameter, of the last image
constexpr int kRoundsBetween = 2;
constexpr int kLastRounds = 2;
constexpr double kLightNodes = 12;   // [a] between the nodes of the light
constexpr double kUnusual = 3;       // medians of the residual: a sphere is in doubt
constexpr double kSameSphere = 0.3;  // [a]

Vec2 in_plane(const Point3& p) {
    return {static_cast<double>(p.x), static_cast<double>(p.y)};
}

/// Distance of a sphere in doubt from the nearest disc that it can have begun as, per axis [a].
Vec2 way_from(const PointGrid& discs, Vec2 fitted) {
    Vec2 way{0, 0};
    double nearest = kSameSphere * kSameSphere;
    discs.near(fitted, kSameSphere, [&](std::uint32_t, Vec2 disc) {
        const double squared = squared_norm(disc - fitted);
        if (squared >= nearest) return;
        nearest = squared;
        way = disc - fitted;
    });
    return way;
}

/// Marks the spheres about which the residual is unusual.
void mark_doubtful(const std::vector<Point3>& start, BrightnessSynthesis& result) {
    const std::size_t n = result.spheres.size();
    result.is_doubtful.assign(n, 0);
    result.way_from_disc.assign(n, {0, 0});
    if (n == 0) return;
    std::vector<double> sorted;
    for (const SphereError& e : result.error) sorted.push_back(e.residual);
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(n / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    std::vector<Vec2> discs;
    for (const Point3& p : start) discs.push_back(in_plane(p));
    const PointGrid grid(discs, kSameSphere);
    for (std::size_t i = 0; i < n; ++i) {
        if (!(result.error[i].residual > kUnusual * *middle)) continue;
        result.is_doubtful[i] = 1;
        result.way_from_disc[i] = way_from(grid, in_plane(result.spheres[i]));
    }
}

}  // namespace

BrightnessSynthesis synthesise_brightness(const Image& seen, const Image& seen_ceiling,
                                          double diameter, const BrightnessStart& start,
                                          double height, int searches, int threads) {
    BrightnessSynthesis result;
    Image brightness = seen;
    Image ceiling = seen_ceiling;
    const auto even_out_by = [&](const SynthesisFit& fitted) {
        brightness = seen;
        ceiling = seen_ceiling;
        result.uneven = even_out(brightness, ceiling, fitted.rendering(), kLightNodes * diameter,
                                 static_cast<int>(std::ceil(diameter)));
    };
    SynthesisLimits limits{.height = height};
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
        rough.start(start.spheres, start.optics);
        if (!start.are_heights_known) {
            result.rounds += rough.find_heights(limits);
        } else {  // they are those of the frame before
            refine(rough, 1);
        }
        std::vector<Point3> found = rough.spheres();
        even_out_by(rough);
        rough.start(start.spheres, start.optics);
        result.residual_before = rough.rms();
        fit.start(std::move(found), start.optics);
    }
    if (!start.are_optics_known) fit.fit_optics();
    refine_with_optics(start.are_heights_known ? 1 : kRoundsBetween);
    even_out_by(fit);
    fit.relight();
    for (int search = 0; search < searches; ++search) {
        std::vector<Point3> better;
        const ArrangementChanges changes = improve_arrangement(
            brightness, ceiling, fit, start.spheres, diameter, limits, threads, better);
        result.trials += changes.trials;
        if (changes.lifted + changes.added + changes.removed == 0) break;
        result.added += changes.added;
        result.removed += changes.removed;
        result.lifted += changes.lifted;
        fit.replace(std::move(better));
        refine_with_optics(kRoundsBetween);
    }
    even_out_by(fit);
    fit.relight();
    refine(fit, 1);
    fit.sharpen(kManyRays);
    refine(fit, kLastRounds);

    result.error = sphere_errors(fit, threads);
    result.spheres = fit.spheres();
    result.optics = fit.optics();
    result.optics_error = fit.optics_error();
    result.light = fit.light();
    result.residual = fit.residual();
    result.residual_rms = fit.rms();
    result.unexplained =
        coherent_rms(fit.residual(), static_cast<int>(std::ceil(diameter))) / fit.light().gain;
    mark_doubtful(start.spheres, result);
    if (start.wants_overlap_factor) {
        result.overlap_factor = overlap_factor(fit, result.is_doubtful, threads);
    }
    return result;
}

}  // namespace grainfield::tracking
