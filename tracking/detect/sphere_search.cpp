#include "tracking/detect/sphere_search.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <optional>

#include "tracking/detect/local_maxima.h"
#include "tracking/detect/one_for_two.h"
#include "tracking/detect/remainder.h"
#include "tracking/detect/second_look.h"
#include "tracking/detect/sphere_room.h"

namespace grainfield::tracking {
namespace {

/// Most rounds of sweeps at the end. Each ends when no two discs came together; the neighbours of
/// one that goes settle in the next round. Few frames need a second one.
constexpr int kLastRounds = 4;
/// A gain above this share of the threshold is tried, for neighbours that cover for a missing
/// sphere take most of what it will explain. Chosen: too low costs time only, since what then
/// explains less than the threshold goes again.
constexpr double kCandidateShare = 0.2;
/// A gain is also above this many times the misfit that is usual within a disc's reach. No disc can
/// gain more than the misfit there, so that usual places (one) are never tried.
constexpr double kUnusual = 2;
/// A gain above this share of a full one is tried in any case: half a sphere is dark there.
constexpr double kSurely = 0.5;
/// Nearer than this to a rejected disc nothing is tried again: the gate of matching, D/4.
constexpr double kSameAgain = 0.25;  // [D]
/// A place that was tried so often is left. A disc that goes may have moved farther than D/4, so
/// that only where it ended is rejected: it would come and go to the last pass. Chosen: neighbours
/// that have settled anew may make a second try a good one.
constexpr int kMostTries = 3;
/// Share of the white noise in 3 × 3 blocks that is counted as noise. Its sum over n = 9 B² pixels
/// scatters by sqrt(2/n), 4.7 % for blocks of 10 px: 0.9 is two standard deviations below its mean,
/// so that in 98 % of all places no gain is overlooked for the noise.
constexpr double kMostlyNoise = 0.9;
/// Both halves of a split disc go so far: 0.6 D apart, the middle between the least separation
/// (0.34 D) and 0.9 D, where the discs of two spheres hardly overlap.
constexpr double kHalfSplit = 0.3;  // [D]
/// A sphere must explain this many times the usual misfit m² A within its reach. A false disc adds
/// nothing but fits what is left, m² A at most where nothing is unusual. The factor is chosen, not
/// derived: it makes the threshold of the real frame (m = 0.06) the most that is asked, and leaves
/// it to the noise where the model is exact.
constexpr double kMisfits = 12;
/// The bounds of that threshold, as shares of what an isolated sphere explains. In a thick layer
/// spheres below two others explain 0.04 and no more. The upper bound is the best of 0.04 to 0.15
/// on cameras drawn at random and a film, where room is asked for (docs/tracking/room.md).
/// Where a is not known it cannot be: on the real frame doubtful spheres lie below 0.15.
constexpr double kLeastEvidence = 0.04;
constexpr double kMostEvidence = 0.15;
constexpr double kMostBesideRoom = 0.08;
/// In a crystal two discs can fit one sphere better than one does, and three two. Each explains
/// 0.08 to 0.3 of an isolated sphere. So do a few true spheres in a thick liquid.
constexpr double kDoubtful = 0.25;  // share of what an isolated sphere explains
/// Most doubtful spheres that are true have room with this granted, and one in ten of those that
/// are false.
constexpr double kClearly = 0.03;  // [a]
/// Where more than this many times as many lack it as have it, and at least so many, all doubtful
/// spheres are taken for false ones: in crystals nine times as many lack it and more, in liquids
/// fewer as a rule (docs/tracking/room.md). So it is in this frame and those that start from it.
/// Chosen.
constexpr double kMostTight = 2;
constexpr int kLeastTight = 5;
/// Elsewhere this is granted, for what the bias of the model does to true spheres. False ones are
/// 0.02 to 0.2 a too near to others. Chosen between the two.
constexpr GrantedRoom kGranted{.corrected = 0.10, .fitted = 0.08};

/// What a disc must be to stay.
struct Demands {
    double threshold;        ///< explains as much [contrast² px]
    double separation;       ///< from a stronger one [px]
    double doubtful;         ///< explains as much, or has room [contrast² px]
    const SphereRoom* room;  ///< null: not asked for
    GrantedRoom granted;
};

/// Weakest first: discs that explain less than the threshold, the weaker of every pair nearer than
/// the separation, and doubtful ones without room. Neighbours of a disc that goes stay for this
/// pass, since they may explain more now.
std::vector<char> discs_to_keep(const JointFit& fit, const std::vector<double>& explained,
                                const Demands& demands) {
    const std::vector<Vec2>& positions = fit.positions();
    const int width = fit.darkness().width();
    const int height = fit.darkness().height();
    PointGrid all(width, height, demands.separation);
    for (std::size_t j = 0; j < positions.size(); ++j) {
        all.add(positions[j], static_cast<std::uint32_t>(j));
    }
    std::vector<char> keep(positions.size(), 1);
    const auto is_crowded = [&](std::uint32_t j) {
        bool crowded = false;
        all.near(positions[j], demands.separation, [&](std::uint32_t other, Vec2) {
            crowded = crowded || (other != j && keep[other] != 0);
        });
        if (crowded || demands.room == nullptr || explained[j] >= demands.doubtful) return crowded;
        return !demands.room->has(j, demands.granted, keep);
    };
    std::vector<std::uint32_t> suspects;
    for (std::uint32_t j = 0; j < positions.size(); ++j) {
        if (explained[j] < demands.threshold || is_crowded(j)) suspects.push_back(j);
    }
    std::sort(suspects.begin(), suspects.end(), [&](std::uint32_t i, std::uint32_t j) {
        return explained[i] != explained[j] ? explained[i] < explained[j] : i < j;
    });
    const double influence = 2 * fit.disc().reach();
    PointGrid gone(width, height, influence);
    for (const std::uint32_t j : suspects) {
        if (explained[j] >= demands.threshold && !is_crowded(j)) continue;
        if (gone.any(positions[j], influence)) continue;
        keep[j] = 0;
        gone.add(positions[j], j);
    }
    return keep;
}

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

DetectionOptions in_blocks(DetectionOptions options, Binning blocks) {
    if (options.sphere_diameter) *options.sphere_diameter /= blocks.factor;
    options.beyond = 0.5 * (blocks.factor - 1) / blocks.factor;
    return options;
}

OptionTable describe(DetectionOptions& options) {
    OptionTable table("detect");
    table.number("separation", options.separation, "D", {0.05, 2},
                 "two centres nearer than this are one sphere");
    table.number(
        "evidence", options.evidence, "-", {0, 1},
        "share of an isolated sphere's misfit that each sphere must explain; auto: 0.04 to 0.15, "
        "as the image model fits, 0.25 in crystals of mirrors");
    table.number("border", options.border, "D", {0, 10},
                 "centres nearer to the image border than this are not reported");
    return table;
}

namespace {

std::optional<std::uint32_t> nearest(const PointGrid& points, Vec2 p, double distance) {
    std::optional<std::uint32_t> best;
    double least = 0;
    points.near(p, distance, [&](std::uint32_t index, Vec2 point) {
        const double d = squared_norm(point - p);
        if (best && (d > least || (d == least && index > *best))) return;
        best = index;
        least = d;
    });
    return best;
}

}  // namespace

SphereSearch::SphereSearch(JointFit& fit, DiscCorrelation& correlation,
                           const DetectionOptions& options, const BiasCorrection* correction)
    : options_(options),
      disc_(fit.disc()),
      correlation_(correlation),
      fit_(fit),
      correction_(correction),
      rejected_(fit.darkness().width(), fit.darkness().height(), kSameAgain * disc_.diameter),
      tried_(rejected_),
      separation_(options.separation * disc_.diameter) {
    summary_.doubtful_are_false = options.doubtful_are_false && options.sphere_diameter.has_value();
}

void SphereSearch::seed() {
    const auto begin = Clock::now();
    Image inverse = correlation_.chi_squared(fit_.darkness(), fit_.transmission());
    for (float& v : inverse.pixels()) v = 1.0F / std::max(v, 1e-3F);
    const auto cutoff = static_cast<float>(options_.cutoff);
    std::vector<Vec2> places;
    for (const Peak& peak :
         local_maxima(inverse, cutoff, 0.6 * disc_.diameter / correlation_.factor())) {
        places.push_back(correlation_.in_frame(peak.position));
    }
    // Neighbours in the image become neighbours in memory.
    const double band = 2 * disc_.diameter;
    std::sort(places.begin(), places.end(), [&](Vec2 a, Vec2 b) {
        const double row_a = std::floor(a.y / band);
        const double row_b = std::floor(b.y / band);
        return row_a != row_b ? row_a < row_b : a.x != b.x ? a.x < b.x : a.y < b.y;
    });
    fit_.add_all(places);
    summary_.detect_seconds += seconds_since(begin);
}

void SphereSearch::forget_rejections() {
    rejected_ =
        PointGrid(fit_.darkness().width(), fit_.darkness().height(), kSameAgain * disc_.diameter);
    tried_ = rejected_;
    rejected_at_ = 0;
}

bool SphereSearch::is_tried_out(Vec2 place) const {
    int tries = 0;
    tried_.near(place, kSameAgain * disc_.diameter, [&](std::uint32_t, Vec2) { ++tries; });
    return tries >= kMostTries;
}

std::int64_t SphereSearch::remove_unfounded() {
    // Nothing has changed since all were found to be founded.
    if (summary_.steps == judged_at_) return 0;
    const Remainder left = remainder(fit_.darkness(), fit_.transmission());
    summary_.noise = left.noise;
    summary_.misfit = std::sqrt(left.misfit);
    const double isolated = correlation_.full_gain();
    const double area = std::numbers::pi * disc_.reach() * disc_.reach();
    const double needed = kMisfits * left.misfit * area;
    // Where the model fits, what explains little is no less sure.
    asks_for_room_ = !options_.evidence && !summary_.doubtful_are_false &&
                     options_.sphere_diameter && needed > kMostBesideRoom * isolated;
    if (options_.evidence) {
        threshold_ = *options_.evidence * isolated;
    } else if (summary_.doubtful_are_false) {
        threshold_ = kDoubtful * isolated;
    } else if (asks_for_room_) {
        threshold_ = kMostBesideRoom * isolated;
    } else {
        threshold_ = std::clamp(needed, kLeastEvidence * isolated, kMostEvidence * isolated);
    }
    threshold_ = std::max(threshold_,
                          options_.significance * options_.significance * left.noise * left.noise);
    summary_.evidence = threshold_ / isolated;
    // Judged by what was left while most spheres were missing.
    if (threshold_ < 0.5 * rejected_at_) forget_rejections();
    std::optional<SphereRoom> room;
    if (asks_for_room_) room.emplace(fit_, cell(), correction_);
    const std::vector<char> keep = discs_to_keep(fit_, fit_.explained(),
                                                 {.threshold = threshold_,
                                                  .separation = separation_,
                                                  .doubtful = kDoubtful * isolated,
                                                  .room = room ? &*room : nullptr,
                                                  .granted = kGranted});
    std::int64_t removed = 0;
    for (std::size_t j = 0; j < keep.size(); ++j) {
        if (keep[j]) continue;
        ++removed;
        rejected_.add(fit_.positions()[j], 0);
    }
    if (removed > 0) {
        rejected_at_ = std::max(rejected_at_, threshold_);
        fit_.keep_only(keep);
    }
    summary_.removed += removed;
    judged_at_ = removed == 0 ? summary_.steps : -1;
    return removed;
}

/// One disc may have settled halfway between two spheres. It is moved away from `place`, where
/// another would explain much, and a second one is put on the other side.
void SphereSearch::split(std::uint32_t j, Vec2 place) {
    const Vec2 middle = fit_.positions()[j];
    const Vec2 towards = place - middle;
    const double length = norm(towards);
    const Vec2 half = length > 0 ? (kHalfSplit * disc_.diameter / length) * towards
                                 : Vec2{kHalfSplit * disc_.diameter, 0};
    fit_.move(j, middle - half);
    fit_.add(middle + half);
}

/// The map of likelihood gain where it can reach `least`: a disc can lower the misfit by no more
/// than the misfit within its reach. Empty if that is nowhere enough.
Image SphereSearch::gain_above(const ResidualBlocks& residual, double least) {
    const std::vector<PixelBlock> places = where_gain_reaches(residual, least);
    if (places.empty()) {
        ++summary_.maps_skipped;
        return {};
    }
    if (!correlation_.are_few(places)) {
        return correlation_.gain(fit_.darkness(), fit_.transmission());
    }
    ++summary_.maps_in_part;
    return correlation_.gain_in(places, fit_.darkness(), fit_.transmission());
}

/// Where the model is not perfect, as on every real image, small gains are to be had anywhere.
/// Where most spheres are missing the residual is large everywhere, and a gain of half a sphere is
/// a candidate all the same.
double SphereSearch::least_gain(const ResidualBlocks& residual) const {
    const double per_pixel = residual.total() / std::max(1.0, fit_.scene().pixels());
    const double usual = per_pixel * std::numbers::pi * disc_.reach() * disc_.reach();
    const double unusual = std::min(kUnusual * usual, kSurely * correlation_.full_gain());
    return std::max(kCandidateShare * threshold_, unusual);
}

std::vector<PixelBlock> SphereSearch::where_gain_reaches(const ResidualBlocks& residual,
                                                         double least) const {
    return residual.holding(least + kMostlyNoise * residual.white(summary_.noise));
}

bool SphereSearch::misses_any(const ResidualBlocks& residual) {
    return misses(residual, least_gain(residual) + kMostlyNoise * residual.white(summary_.noise));
}

bool SphereSearch::misses_whole_ones(const ResidualBlocks& residual) {
    return misses(residual, kSurely * correlation_.full_gain() +
                                residual.white(residual.rms(fit_.scene().pixels())));
}

bool SphereSearch::misses(const ResidualBlocks& residual, double least) {
    if (!residual.holding(least).empty()) return true;
    ++summary_.passes;
    ++summary_.maps_skipped;
    summary_.settled_detection = true;
    return false;
}

std::int64_t SphereSearch::add_missing() {
    const PaddedImage& darkness = fit_.darkness();
    const ResidualBlocks residual = residual_of(fit_);
    const double least = least_gain(residual);
    const Image gain = gain_above(residual, least);
    if (gain.size() == 0) return 0;
    PointGrid present(darkness.width(), darkness.height(), separation_);
    for (std::uint32_t j = 0; j < fit_.positions().size(); ++j) present.add(fit_.positions()[j], j);
    std::vector<char> is_split(fit_.positions().size(), 0);
    std::int64_t added = 0;
    // Neighbours have moved to cover for a missing sphere, so its gain before they move back is
    // only part of what it will explain; a sphere that explains too little is removed again and its
    // place not tried again.
    for (const Peak& peak : local_maxima(gain, static_cast<float>(least),
                                         0.8 * disc_.diameter / correlation_.factor())) {
        const Vec2 place = correlation_.in_frame(peak.position);
        if (rejected_.any(place, kSameAgain * disc_.diameter) || is_tried_out(place)) continue;
        const std::optional<std::uint32_t> blocker = nearest(present, place, separation_);
        if (!blocker) {
            fit_.add(place);
        } else if (is_split[*blocker] == 0) {
            split(*blocker, place);
            is_split[*blocker] = 1;
        } else {
            continue;
        }
        tried_.add(place, 0);
        ++added;
    }
    summary_.added += added;
    if (added > 0) judged_at_ = -1;
    return added;
}

void SphereSearch::run(const RefinementOptions& rough) {
    summary_.settled_detection = false;
    const int last =
        summary_.passes + (options_.goal == SearchGoal::most_spheres ? 1 : options_.max_passes);
    while (summary_.passes < last && !summary_.settled_detection) {
        ++summary_.passes;
        auto begin = Clock::now();
        summary_.steps += fit_.refine(rough, Drawing::roughly).steps;
        summary_.refine_seconds += seconds_since(begin);
        begin = Clock::now();
        const std::int64_t removed = remove_unfounded();
        summary_.settled_detection = add_missing() == 0 && removed == 0;
        summary_.detect_seconds += seconds_since(begin);
    }
}

bool SphereSearch::look_again(const RefinementOptions& refinement, const ResidualBlocks& residual) {
    const auto begin = Clock::now();
    const SecondLook look = tracking::look_again(fit_, correlation_, separation_, summary_.noise,
                                                 summary_.evidence, refinement, residual);
    summary_.trials += look.trials;
    summary_.trials_kept += look.kept;
    summary_.added += look.kept;
    summary_.steps += look.steps;
    if (look.steps > 0) forget_judgement();
    summary_.detect_seconds += seconds_since(begin);
    return look.steps > 0;
}

bool SphereSearch::put_one_for_two(const RefinementOptions& refinement) {
    if (correction_ == nullptr || !options_.sphere_diameter || summary_.noise <= 0) return false;
    const auto begin = Clock::now();
    const OneForTwo put = try_one_for_two(fit_, cell(), *correction_, summary_.noise, refinement);
    summary_.trials += put.trials;
    summary_.trials_kept += put.kept;
    summary_.mended += put.kept;
    summary_.removed += put.kept;
    summary_.steps += put.steps;
    if (put.trials > 0) forget_judgement();
    summary_.detect_seconds += seconds_since(begin);
    return put.trials > 0;
}

void SphereSearch::finish(const RefinementOptions& refinement, Drawing drawing) {
    int rounds = kLastRounds;
    for (int round = 0; round < rounds; ++round) {
        sweep(refinement, drawing);
        if (remove_unfounded() > 0) continue;
        if (!finds_doubtful_false()) break;
        rounds = round + 1 + kLastRounds;  // once a frame at most
    }
}

SphereCell SphereSearch::cell() const {
    return {.diameter = options_.sphere_diameter.value_or(0), .height = options_.cell_height};
}

/// Whether it is seen now that doubtful spheres are false, as most of them hardly have room. Also
/// where the model fits and none is asked for room: on the image of the last fit it may fit because
/// of discs that are not there. Discs that the border or a mask cuts explain little, whatever they
/// are.
bool SphereSearch::finds_doubtful_false() {
    if (options_.evidence || summary_.doubtful_are_false || !options_.sphere_diameter ||
        correction_ == nullptr || options_.goal != SearchGoal::every_sphere) {
        return false;
    }
    const double doubtful = kDoubtful * correlation_.full_gain();
    const std::vector<double>& explained = fit_.explained();
    const SphereRoom room(fit_, cell(), correction_);
    int clear = 0;
    int tight = 0;
    for (std::size_t j = 0; j < explained.size(); ++j) {
        if (explained[j] >= doubtful || !is_whole(fit_.positions()[j])) continue;
        if (!room.is_corrected(j)) continue;
        (room.has(j, {.corrected = kClearly, .fitted = 0}) ? clear : tight) += 1;
    }
    if (tight < kLeastTight || tight <= kMostTight * clear) return false;
    summary_.doubtful_are_false = true;
    forget_judgement();
    return true;
}

void SphereSearch::start_over() {
    forget_judgement();
    remove_unfounded();
    forget_rejections();
}

/// Whether a disc lies in the image with all of its edge, and no mask hides any of that.
bool SphereSearch::is_whole(Vec2 p) const {
    constexpr int kDirections = 16;
    const PaddedImage& transmission = fit_.transmission();
    for (int k = 0; k < kDirections; ++k) {
        const double angle = 2 * std::numbers::pi * k / kDirections;
        const double x = std::round(p.x + disc_.reach() * std::cos(angle));
        const double y = std::round(p.y + disc_.reach() * std::sin(angle));
        if (x < 0 || y < 0 || x >= transmission.width() || y >= transmission.height()) return false;
        if (transmission.row(static_cast<int>(y))[static_cast<int>(x)] <= 0) return false;
    }
    return true;
}

void SphereSearch::sweep(const RefinementOptions& refinement, Drawing drawing) {
    const auto begin = Clock::now();
    summary_.steps += fit_.refine(refinement, drawing).steps;
    summary_.refine_seconds += seconds_since(begin);
}

}  // namespace grainfield::tracking
