#include "tracking/detect/sphere_search.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "tracking/detect/local_maxima.h"
#include "tracking/detect/second_look.h"
#include "tracking/layers/sphere_cell.h"
#include "tracking/synthesis/bias_correction.h"

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
/// Share of the image above which transforms of all of it are cheaper than those of the places.
constexpr double kFewPlaces = 0.2;
/// Share of the white noise in 3 × 3 blocks that is counted as noise. Its sum over n = 9 B² pixels
/// scatters by sqrt(2/n), 4.7 % for blocks of 10 px: 0.9 is two standard deviations below its mean,
/// so that in 98 % of all places no gain is overlooked for the noise.
constexpr double kMostlyNoise = 0.9;
/// Both halves of a split disc go so far: 0.6 D apart, the middle between the least separation
/// (0.34 D) and 0.9 D, where the discs of two spheres hardly overlap.
constexpr double kHalfSplit = 0.3;  // [D]
/// A larger deviation belongs to a missing sphere, of darkness 1 where nothing covers it, and not
/// to the misfit of the model: rims and meeting edges leave less.
constexpr float kMissing = 0.25F;  // [contrast]
/// A sphere must explain this many times the usual misfit m² A within its reach. A false disc adds
/// nothing but fits what is left, m² A at most where nothing is unusual. The factor is chosen, not
/// derived: it makes the threshold of the real frame (m = 0.06) the most that is asked, and leaves
/// it to the noise where the model is exact.
constexpr double kMisfits = 12;
/// The bounds of that threshold, as shares of what an isolated sphere explains. In a thick layer
/// spheres below two others explain 0.04 and no more. The upper bound is the best of 0.04 to 0.15
/// on cameras drawn at random and a film, where room is asked for (docs/tracking/detection.md).
/// Where a is not known it cannot be: on the real frame doubtful spheres lie below 0.15.
constexpr double kLeastEvidence = 0.04;
constexpr double kMostEvidence = 0.15;
constexpr double kMostBesideRoom = 0.08;
/// Of true spheres the fewer are there the less they explain: in a thick liquid a tenth as many
/// explain 0.08 to 0.15 of an isolated one as 0.15 to 0.25 (kDoubtful). In a crystal of mirrors
/// three discs in a row fit two spheres, and have room: 0.35 to 0.8 as many. Above this share and
/// from this number on those that explain less than 0.15 are taken for false ones, in this frame
/// and those that start from it. Chosen between the two.
constexpr double kTooManyWeak = 0.25;
constexpr int kLeastWeak = 5;
/// In a crystal two discs can fit one sphere better than one does. Each explains 0.08 to 0.3 of an
/// isolated sphere, and is 0.02 to 0.2 a too near to others to have room. So are a few true spheres
/// in a thick liquid, by the bias of the model. Where that is corrected true ones have more room
/// than false ones. All are chosen between the two.
constexpr double kDoubtful = 0.25;            // share of what an isolated sphere explains
constexpr double kGranted = 0.08;             // [a]
constexpr double kGrantedIfCorrected = 0.06;  // [a]
/// No correction moves a doubtful sphere farther: others of its size are not learned from [a].
constexpr double kMostCorrected = 0.15;

/// What is left of the image, from evenly spaced rows, as many as a percent of accuracy needs.
struct Remainder {
    double noise = 0;
    /// Mean square where there are spheres, without what is left of missing ones.
    double misfit = 0;
};

constexpr std::size_t kLeastPixels = 100;  // that show the noise
/// Flat pixels that vary by this share of what is left about the spheres, and neighbouring ones
/// that differ by less than this share of it: what flat pixels show is not the noise of the layer.
constexpr double kAlike = 0.8;

/// RMS, outliers beyond four robust standard deviations left out. Where half of the values are 0,
/// as in frames of few grey levels, none are.
double robust_rms(std::vector<float>& sizes) {
    if (sizes.empty()) return 0;
    const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
    std::nth_element(sizes.begin(), middle, sizes.end());
    const float widest =
        *middle > 0 ? 4 * 1.4826F * *middle : std::numeric_limits<float>::infinity();
    double sum = 0;
    double n = 0;
    for (const float size : sizes) {
        if (size > widest) continue;
        sum += static_cast<double>(size) * static_cast<double>(size);
        n += 1;
    }
    return std::sqrt(sum / n);
}

/// Where the noise of a frame shows.
struct NoiseSamples {
    std::vector<float> flat;   ///< image − model of clear pixels and of cores
    std::vector<float> clear;  ///< of clear pixels alone
    /// Second differences of image − model along the rows, of white noise √6 of it. Structure that
    /// is wider than three pixels is not in them.
    std::vector<float> bends, clear_bends;

    /// RMS [contrast]. `left`: RMS of image − model where there are spheres. That of flat pixels,
    /// unless they are few, or not flat in the image, or so bright that they have more photon noise
    /// than the layer.
    double noise(double left) {
        double of_neighbours = robust_rms(bends) / std::sqrt(6.0);
        // What a camera or codec has smoothed varies less from pixel to pixel.
        if (clear_bends.size() >= kLeastPixels) {
            const double white = robust_rms(clear_bends) / std::sqrt(6.0);
            if (white > 0) of_neighbours *= std::max(1.0, robust_rms(clear) / white);
        }
        if (flat.size() < kLeastPixels) return of_neighbours;
        const double of_flat = robust_rms(flat);
        const bool is_no_noise = of_flat > kAlike * left && of_neighbours < kAlike * of_flat;
        return is_no_noise ? of_neighbours : of_flat;
    }
};

Remainder remainder(const PaddedImage& darkness, const PaddedImage& transmission) {
    constexpr double kSample = 3e4;
    constexpr float kClear = 0.995F;
    const double pixels = static_cast<double>(darkness.width()) * darkness.height();
    const int stride = std::max(1, static_cast<int>(pixels / kSample));
    NoiseSamples samples;
    double squares = 0;
    double covered = 0;
    for (int y = stride / 2; y < darkness.height(); y += stride) {
        const float* d = darkness.row(y);
        const float* t = transmission.row(y);
        for (int x = 0; x < darkness.width(); ++x) {
            if (t[x] <= 0) continue;  // not visible
            const float deviation = std::abs(d[x] - 1.0F + t[x]);
            const bool is_clear = t[x] > kClear;
            const bool is_middle_of_three = x % 3 == 1 && x + 1 < darkness.width();
            if (is_middle_of_three && t[x - 1] > 0 && t[x + 1] > 0) {
                const float bend =
                    std::abs(d[x - 1] + t[x - 1] + d[x + 1] + t[x + 1] - 2 * (d[x] + t[x]));
                samples.bends.push_back(bend);
                if (is_clear && t[x - 1] > kClear && t[x + 1] > kClear) {
                    samples.clear_bends.push_back(bend);
                }
            }
            if (is_clear) samples.clear.push_back(deviation);
            if (is_clear || t[x] < 0.005F) samples.flat.push_back(deviation);
            if (is_clear || deviation > kMissing) continue;
            squares += static_cast<double>(deviation) * static_cast<double>(deviation);
            covered += 1;
        }
    }
    const double misfit = covered > 0 ? squares / covered : 0;
    return {samples.noise(std::sqrt(misfit)), misfit};
}

/// What a disc must be to stay.
struct Demands {
    double threshold;   ///< explains as much [contrast² px]
    double separation;  ///< from a stronger one [px]
    double doubtful;    ///< explains as much, or has room in `cell` [contrast² px]
    SphereCell cell;
    const BiasCorrection* correction;  ///< of positions, before room is judged; null: none
};

/// Weakest first: discs that explain less than the threshold, the weaker of every pair nearer than
/// the separation, and doubtful ones without room. Neighbours of a disc that goes stay for this
/// pass, since they may explain more now.
std::vector<char> discs_to_keep(const JointFit& fit, const std::vector<double>& explained,
                                const Demands& demands) {
    const std::vector<Vec2>& positions = fit.positions();
    const int width = fit.darkness().width();
    const int height = fit.darkness().height();
    const double a = demands.cell.diameter;
    const bool is_corrected = demands.correction != nullptr && demands.doubtful > 0;
    // A neighbour may come this much nearer.
    const double reach = std::max(demands.separation, a * (is_corrected ? 1 + kMostCorrected : 1));
    PointGrid all(width, height, reach);
    for (std::size_t j = 0; j < positions.size(); ++j) {
        all.add(positions[j], static_cast<std::uint32_t>(j));
    }
    std::vector<char> keep(positions.size(), 1);
    std::optional<BiasCorrector> corrector;
    if (is_corrected) {
        corrector.emplace(*demands.correction, fit.darkness(), fit.transmission(), positions, a);
    }
    const auto corrected = [&](Vec2 p) {
        const Vec2 way = corrector->corrected(p) - p;
        return p + std::min(1.0, kMostCorrected * a / std::max(norm(way), 1e-9)) * way;
    };
    const auto lacks_room = [&](Vec2 place, std::vector<Vec2>& neighbours) {
        const auto reaches = [&](Vec2 p) { return corrector->reaches(p); };
        if (!corrector || !reaches(place) ||
            !std::all_of(neighbours.begin(), neighbours.end(), reaches)) {
            return !has_room(demands.cell, place, neighbours, kGranted);
        }
        for (Vec2& p : neighbours) p = corrected(p);
        return !has_room(demands.cell, corrected(place), neighbours, kGrantedIfCorrected);
    };
    const auto is_crowded = [&](std::uint32_t j) {
        const bool is_doubtful = explained[j] < demands.doubtful;
        bool crowded = false;
        std::vector<Vec2> neighbours;
        all.near(positions[j], is_doubtful ? reach : demands.separation,
                 [&](std::uint32_t other, Vec2 p) {
                     if (other == j || keep[other] == 0) return;
                     const double squared = squared_norm(p - positions[j]);
                     crowded = crowded || squared < demands.separation * demands.separation;
                     neighbours.push_back(p);
                 });
        return crowded || (is_doubtful && lacks_room(positions[j], neighbours));
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

OptionTable describe(DetectionOptions& options) {
    OptionTable table("detect");
    table.number("separation", options.separation, "D", {0.05, 2},
                 "two centres nearer than this are one sphere");
    table.number(
        "evidence", options.evidence, "-", {0, 1},
        "share of an isolated sphere's misfit that each sphere must explain; auto: 0.04 to 0.15, "
        "as the image model fits");
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
      separation_(options.separation * disc_.diameter) {
    summary_.weak_are_false = options.weak_are_false && options.sphere_diameter.has_value();
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
    rejected_at_ = 0;
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
    asks_for_room_ = !options_.evidence && !summary_.weak_are_false && options_.sphere_diameter &&
                     needed > kMostBesideRoom * isolated;
    if (options_.evidence) {
        threshold_ = *options_.evidence * isolated;
    } else if (summary_.weak_are_false) {
        threshold_ = kMostEvidence * isolated;
    } else {
        threshold_ = std::clamp(needed, kLeastEvidence * isolated,
                                (asks_for_room_ ? kMostBesideRoom : kMostEvidence) * isolated);
    }
    threshold_ = std::max(threshold_,
                          options_.significance * options_.significance * left.noise * left.noise);
    summary_.evidence = threshold_ / isolated;
    // Judged by what was left while most spheres were missing.
    if (threshold_ < 0.5 * rejected_at_) forget_rejections();
    const SphereCell cell{.diameter = options_.sphere_diameter.value_or(0),
                          .height = options_.cell_height};
    const double doubtful = asks_for_room_ ? std::max(threshold_, kDoubtful * isolated) : 0;
    const std::vector<char> keep = discs_to_keep(
        fit_, fit_.explained(), {threshold_, separation_, doubtful, cell, correction_});
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
    const PaddedImage& darkness = fit_.darkness();
    double area = 0;
    for (const PixelBlock& p : places) area += static_cast<double>(p.x1 - p.x0) * (p.y1 - p.y0);
    if (area > kFewPlaces * darkness.width() * darkness.height()) {
        return correlation_.gain(darkness, fit_.transmission());
    }
    ++summary_.maps_in_part;
    return correlation_.gain_in(places, darkness, fit_.transmission());
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
    if (!where_gain_reaches(residual, least_gain(residual)).empty()) return true;
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
        if (rejected_.any(place, kSameAgain * disc_.diameter)) continue;
        const std::optional<std::uint32_t> blocker = nearest(present, place, separation_);
        if (!blocker) {
            fit_.add(place);
        } else if (is_split[*blocker] == 0) {
            split(*blocker, place);
            is_split[*blocker] = 1;
        } else {
            continue;
        }
        ++added;
    }
    summary_.added += added;
    if (added > 0) judged_at_ = -1;
    return added;
}

void SphereSearch::run(const RefinementOptions& rough) {
    summary_.settled_detection = false;
    const int most = options_.goal == SearchGoal::most_spheres ? 1 : options_.max_passes;
    while (summary_.passes < most && !summary_.settled_detection) {
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
    summary_.added += look.kept;
    summary_.steps += look.steps;
    if (look.steps > 0) forget_judgement();
    summary_.detect_seconds += seconds_since(begin);
    return look.steps > 0;
}

void SphereSearch::finish(const RefinementOptions& refinement, Drawing drawing) {
    int rounds = kLastRounds;
    for (int round = 0; round < rounds; ++round) {
        sweep(refinement, drawing);
        if (remove_unfounded() > 0) continue;
        if (!finds_weak_false()) break;
        rounds = round + 1 + kLastRounds;  // once a frame at most
    }
}

/// Whether it is seen now that those which explain less than 0.15 are false. Discs that the border
/// or a mask cuts explain little, whatever they are.
bool SphereSearch::finds_weak_false() {
    if (!asks_for_room_ || options_.goal != SearchGoal::every_sphere) return false;
    const double isolated = correlation_.full_gain();
    int weak = 0;
    int doubtful = 0;
    const std::vector<double>& explained = fit_.explained();
    for (std::size_t j = 0; j < explained.size(); ++j) {
        if (explained[j] >= kDoubtful * isolated || !is_whole(fit_.positions()[j])) continue;
        (explained[j] < kMostEvidence * isolated ? weak : doubtful) += 1;
    }
    if (weak < kLeastWeak || weak <= kTooManyWeak * doubtful) return false;
    summary_.weak_are_false = true;
    forget_judgement();
    return true;
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
