#include "tracking/detect/second_look.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "tracking/detect/local_maxima.h"
#include "tracking/detect/residual_blocks.h"
#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

/// Unusual is what lies this far above the median, in robust standard deviations: 3e-5 of a
/// Gaussian lies there, 0.4 discs of 11,700. A false alarm costs a trial and changes nothing.
constexpr double kSpreads = 4;
/// … or in medians, if that is less: where the misfit varies much from disc to disc, four
/// deviations would hide a sphere. Chosen.
constexpr double kMedians = 0.5;
/// The misfit must fall by the usual one where each sphere must explain this share of what an
/// isolated one does: four fifths of the upper bound of that share, 0.15, where a is not known. At
/// other shares it must fall in proportion …
constexpr double kPoorModel = 0.12;
/// … and by this much of the usual one at least. Chosen on a film: of trials that gain 0.7 to 1 of
/// it 45 of 67 end within 0.1 a of a true sphere, of those that gain less 33 of 452. 56 other
/// cameras miss least between 0.5 and 0.7 (bench/results/tracking.md).
constexpr double kLeastGain = 2.0 / 3.0;
/// The misfit must fall by the square of this in units of σ². One false disc gains more by chance
/// in 2e-9 of independent places; a frame has about 1e5, so one frame in 5,000.
constexpr double kSignificance = 6;
/// Most rounds: the peaks of gain about one place are tried one after the other. Chosen for the
/// time.
constexpr int kRounds = 8;
/// Most sweeps of a trial: if a step halves in each, D/4 becomes 1e-3 px at D = 16 px.
constexpr int kSweeps = 12;
/// The discs about a trial that go back with it: its neighbours, theirs, and half a disc.
constexpr double kNeighbours = 2.5;  // [D]
/// Trials of one round are so far apart that none moves a neighbour of another one.
constexpr double kApart = 2 * kNeighbours;  // [D]
/// Half the side of the square that is judged: the neighbours at one diameter, and their discs with
/// their edges.
constexpr double kJudged = 1.75;  // [D]
/// Peaks of gain nearer than this are one: less than the least separation of two spheres, 0.34 D …
constexpr double kPeaks = 0.25;  // [D]
/// … and nearer than this to a place that was tried nothing is: less than half of it.
constexpr double kTried = 0.15;  // [D]

struct Trial {
    Vec2 place;
    std::uint32_t added = 0;
    double before = 0;  ///< misfit around
    std::vector<std::pair<std::uint32_t, Vec2>> neighbours;
};

/// Places to try, highest gain first.
std::vector<Vec2> candidates(const JointFit& fit, DiscCorrelation& correlation, double misfit,
                             double least, const ResidualBlocks& residual) {
    const std::vector<PixelBlock> blocks = residual.holding(misfit);
    if (blocks.empty()) return {};
    const PaddedImage& darkness = fit.darkness();
    const bool few = correlation.are_few(blocks);
    const Image whole = few ? Image() : correlation.gain(darkness, fit.transmission());
    const Image& gain = few ? correlation.gain_in(blocks, darkness, fit.transmission()) : whole;
    std::vector<Vec2> places;
    for (const Peak& peak : local_maxima(gain, static_cast<float>(least),
                                         kPeaks * fit.disc().diameter / correlation.factor())) {
        places.push_back(correlation.in_frame(peak.position));
    }
    return places;
}

PointGrid all_discs(const JointFit& fit, double distance) {
    PointGrid all(fit.darkness().width(), fit.darkness().height(), distance);
    for (std::uint32_t j = 0; j < fit.positions().size(); ++j) all.add(fit.positions()[j], j);
    return all;
}

/// Removes trial discs that are not kept and puts their neighbours back. How many stay.
std::int64_t keep_the_better(JointFit& fit, const std::vector<Trial>& trials, double separation,
                             double enough) {
    const PointGrid all = all_discs(fit, separation);
    std::vector<char> keep(fit.positions().size(), 1);
    std::vector<const Trial*> failed;
    for (const Trial& trial : trials) {
        bool is_crowded = false;
        all.near(fit.positions()[trial.added], separation,
                 [&](std::uint32_t j, Vec2) { is_crowded = is_crowded || j != trial.added; });
        const double after = misfit_about(fit, trial.place, kJudged * fit.disc().diameter);
        if (!is_crowded && after < trial.before - enough) continue;
        keep[trial.added] = 0;
        failed.push_back(&trial);
    }
    for (const Trial* trial : failed) {
        for (const auto& [j, place] : trial->neighbours) {
            if (squared_norm(fit.positions()[j] - place) > 0) fit.move(j, place);
        }
    }
    if (!failed.empty()) fit.keep_only(keep);
    return static_cast<std::int64_t>(trials.size() - failed.size());
}

/// Of the sums over three blocks by three about each disc.
struct Level {
    double median, unusual;
};

Level level(const JointFit& fit, const ResidualBlocks& residual) {
    const auto [median, spread] = residual.usual(fit.positions());
    return {median,
            median + (spread > 0 ? std::min(kSpreads * spread, kMedians * median) : median)};
}

/// Whether there may be places to try. If so, all discs are drawn where they are. Where much of the
/// image is unusual, as in layers of mirrors, the map that shows them is made after that, and not
/// twice.
bool may_have_candidates(JointFit& fit, DiscCorrelation& correlation, double least,
                         const ResidualBlocks& residual) {
    const double unusual = level(fit, residual).unusual;
    const std::vector<PixelBlock> blocks = residual.holding(unusual);
    if (blocks.empty()) return false;
    if (correlation.are_few(blocks)) {
        // The gain in a block depends on discs within two reaches.
        fit.draw_pending_near(residual.middles(blocks), 3 * residual.block());
        if (candidates(fit, correlation, unusual, least, residual).empty()) return false;
    }
    fit.draw_pending();
    return true;
}

}  // namespace

SecondLook look_again(JointFit& fit, DiscCorrelation& correlation, double separation, double noise,
                      double evidence, const RefinementOptions& refinement,
                      const ResidualBlocks& residual) {
    SecondLook look;
    if (fit.positions().empty() || noise <= 0) return look;
    const double least = kSignificance * kSignificance * noise * noise;
    if (!may_have_candidates(fit, correlation, least, residual)) return look;
    const double share = std::max(kLeastGain, evidence / kPoorModel);
    const double diameter = fit.disc().diameter;
    const int width = fit.darkness().width();
    const int height = fit.darkness().height();
    RefinementOptions few = refinement;
    few.max_sweeps = std::min(refinement.max_sweeps, kSweeps);
    // What moves by itself must not count for a trial.
    look.steps += fit.refine(few).steps;
    PointGrid tried(width, height, kTried * diameter);
    std::vector<Vec2> places;
    double enough = 0;
    bool is_known = false;
    for (int round = 0; round < kRounds; ++round) {
        if (!is_known) {
            const ResidualBlocks left = residual_of(fit);
            const auto [median, unusual] = level(fit, left);
            places = candidates(fit, correlation, unusual, least, left);
            enough = std::max(least, share * (median - left.white(noise)));
        }
        if (places.empty()) break;
        const PointGrid present = all_discs(fit, kNeighbours * diameter);
        PointGrid taken(width, height, kApart * diameter);
        std::vector<Trial> trials;
        for (const Vec2 place : places) {
            if (tried.any(place, kTried * diameter) || taken.any(place, kApart * diameter))
                continue;
            tried.add(place, 0);
            taken.add(place, 0);
            Trial trial{place, 0, misfit_about(fit, place, kJudged * diameter), {}};
            present.near(place, kNeighbours * diameter,
                         [&](std::uint32_t j, Vec2 p) { trial.neighbours.emplace_back(j, p); });
            trials.push_back(std::move(trial));
        }
        if (trials.empty()) break;
        for (Trial& trial : trials) {
            trial.added = static_cast<std::uint32_t>(fit.positions().size());
            fit.add(trial.place);
        }
        look.steps += fit.refine(few).steps;
        const std::int64_t kept = keep_the_better(fit, trials, separation, enough);
        // Where all have gone back the places are those of before.
        is_known = kept == 0;
        look.steps += fit.refine(few).steps;
        look.trials += static_cast<std::int64_t>(trials.size());
        look.kept += kept;
    }
    return look;
}

}  // namespace grainfield::tracking
