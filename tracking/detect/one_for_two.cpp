#include "tracking/detect/one_for_two.h"

#include <algorithm>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>
#include <vector>

#include "core/support/parallel.h"
#include "tracking/detect/residual_blocks.h"
#include "tracking/detect/sphere_room.h"
#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

/// Chosen, as are the next two, on eight of 40 cameras with crystals. With .03 granted, of trials
/// after which at least three fewer lack room, 222 make it better and 17 worse where the misfit
/// rises by less than 1.25, and 56 and 21 where it rises by 1.25 to 1.5. Of the others about as
/// many do either (docs/tracking/room.md).
constexpr GrantedRoom kGranted{.corrected = 0.05, .fitted = 0.08};
constexpr double kMostRise = 1.25;  // usual misfits
constexpr int kLeastFewer = 3;
/// What one disc of noise may take from the misfit, in σ² (second_look.h).
constexpr double kLeastRise = 36;
constexpr int kMostRounds = 32;
constexpr int kSweeps = 30;
/// The discs about a trial that go back with it, and those that are judged.
constexpr double kAbout = 2.5;  // [D]
/// Trials of one round are so far apart that their squares do not meet, nor even their corners.
constexpr double kApart = 2 * std::numbers::sqrt2 * kAbout;  // [D]
/// Two that are farther apart are two spheres.
constexpr double kPair = 0.95;  // [D]
/// No place is tried that is nearer than this to one that was.
constexpr double kTried = 0.15;  // [D]

/// The discs as they stand.
struct Arrangement {
    std::vector<char> lacks_room;
    PointGrid grid;

    Arrangement(const JointFit& fit, const SphereCell& cell, const BiasCorrection& correction)
        : lacks_room(fit.positions().size(), 0),
          grid(fit.darkness().width(), fit.darkness().height(), kAbout * fit.disc().diameter) {
        SphereRoom room(fit, cell, &correction);
        room.correct_all(fit.threads());
        parallel_for(static_cast<std::int64_t>(lacks_room.size()), fit.threads(),
                     [&](std::int64_t i) {
                         const auto j = static_cast<std::size_t>(i);
                         lacks_room[j] = room.has(j, kGranted) ? 0 : 1;
                     });
        for (std::uint32_t j = 0; j < lacks_room.size(); ++j) grid.add(fit.positions()[j], j);
    }

    std::optional<std::uint32_t> nearest(std::uint32_t j, Vec2 place, double distance) const {
        std::optional<std::uint32_t> best;
        double least = distance * distance;
        grid.near(place, distance, [&](std::uint32_t other, Vec2 p) {
            if (other == j || squared_norm(p - place) >= least) return;
            least = squared_norm(p - place);
            best = other;
        });
        return best;
    }
};

struct Trial {
    Vec2 middle;  ///< of the two
    std::uint32_t gone;
    Vec2 gone_from;
    std::uint32_t partner;
    double misfit = 0;  ///< before, as the next
    int lacking = 0;    ///< of the one that goes and its neighbours
    std::vector<std::pair<std::uint32_t, Vec2>> neighbours = {};  ///< within 2.5 D of the middle
};

std::vector<Trial> choose_trials(JointFit& fit, const Arrangement& now, PointGrid& tried) {
    const double diameter = fit.disc().diameter;
    const std::vector<double>& explained = fit.explained();
    std::vector<std::uint32_t> crowded;
    for (std::uint32_t j = 0; j < now.lacks_room.size(); ++j) {
        if (now.lacks_room[j] != 0) crowded.push_back(j);
    }
    std::sort(crowded.begin(), crowded.end(), [&](std::uint32_t i, std::uint32_t j) {
        return explained[i] != explained[j] ? explained[i] < explained[j] : i < j;
    });
    PointGrid taken(fit.darkness().width(), fit.darkness().height(), kApart * diameter);
    std::vector<Trial> trials;
    for (const std::uint32_t j : crowded) {
        const Vec2 place = fit.positions()[j];
        const std::optional<std::uint32_t> partner = now.nearest(j, place, kPair * diameter);
        if (!partner) continue;
        const Vec2 middle = 0.5 * (place + fit.positions()[*partner]);
        if (tried.any(middle, kTried * diameter) || taken.any(middle, kApart * diameter)) continue;
        tried.add(middle, 0);
        taken.add(middle, 0);
        Trial trial{.middle = middle,
                    .gone = j,
                    .gone_from = place,
                    .partner = *partner,
                    .misfit = misfit_about(fit, middle, kAbout * diameter)};
        now.grid.near(middle, kAbout * diameter, [&](std::uint32_t other, Vec2 p) {
            trial.lacking += now.lacks_room[other];
            if (other != j) trial.neighbours.emplace_back(other, p);
        });
        trials.push_back(std::move(trial));
    }
    return trials;
}

/// Afterwards the trials count discs as the fit does then.
void take_away(JointFit& fit, std::vector<Trial>& trials) {
    std::vector<char> keep(fit.positions().size(), 1);
    for (const Trial& trial : trials) keep[trial.gone] = 0;
    std::vector<std::uint32_t> number(keep.size());
    std::exclusive_scan(keep.begin(), keep.end(), number.begin(), std::uint32_t{0});
    fit.keep_only(keep);
    for (Trial& trial : trials) {
        trial.partner = number[trial.partner];
        for (auto& [j, place] : trial.neighbours) j = number[j];
        fit.move(trial.partner, trial.middle);
    }
}

/// Undoes the trials that do not make it better. How many stay.
std::int64_t keep_the_better(JointFit& fit, const std::vector<Trial>& trials,
                             const Arrangement& now, double most_rise) {
    const double about = kAbout * fit.disc().diameter;
    std::vector<const Trial*> failed;
    for (const Trial& trial : trials) {
        const double rise = misfit_about(fit, trial.middle, about) - trial.misfit;
        int fewer = trial.lacking;
        for (const auto& [j, place] : trial.neighbours) fewer -= now.lacks_room[j];
        if (!(rise < most_rise && fewer >= kLeastFewer)) failed.push_back(&trial);
    }
    for (const Trial* trial : failed) {
        for (const auto& [j, place] : trial->neighbours) {
            if (squared_norm(fit.positions()[j] - place) > 0) fit.move(j, place);
        }
    }
    for (const Trial* trial : failed) fit.add(trial->gone_from);
    return static_cast<std::int64_t>(trials.size() - failed.size());
}

}  // namespace

OneForTwo try_one_for_two(JointFit& fit, const SphereCell& cell, const BiasCorrection& correction,
                          double noise, const RefinementOptions& refinement) {
    OneForTwo result;
    RefinementOptions few = refinement;
    few.max_sweeps = std::min(refinement.max_sweeps, kSweeps);
    PointGrid tried(fit.darkness().width(), fit.darkness().height(), kTried * fit.disc().diameter);
    fit.draw_pending();
    for (; result.rounds < kMostRounds; ++result.rounds) {
        std::vector<Trial> trials = choose_trials(fit, Arrangement(fit, cell, correction), tried);
        if (trials.empty()) break;
        const ResidualBlocks left = residual_of(fit);
        const double usual = left.usual(fit.positions()).median - left.white(noise);
        take_away(fit, trials);
        result.steps += fit.refine(few).steps;
        const std::int64_t kept =
            keep_the_better(fit, trials, Arrangement(fit, cell, correction),
                            std::max(kLeastRise * noise * noise, kMostRise * usual));
        result.steps += fit.refine(few).steps;
        result.trials += static_cast<std::int64_t>(trials.size());
        result.kept += kept;
    }
    return result;
}

}  // namespace grainfield::tracking
