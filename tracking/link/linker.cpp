#include "tracking/link/linker.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/errors.h"
#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

/// The least motion that weights assume [search range]: a video that stands still must not make
/// differences in precision decide alone.
constexpr double kLeastMotion = 0.01;

/// Search range that is not given [standard deviations of a step per axis].
constexpr double kReach = 4.5;
/// A frame is linked again if its steps ask for so much more range.
constexpr double kWorthwhile = 1.2;
/// Particles that tell how far errors enter steps.
constexpr std::size_t kStepSample = 1000;

void require_linkable(const LinkState& state, std::int64_t frame,
                      const std::vector<Vec2>& positions, const std::vector<Vec2>& errors) {
    if (state.frame && frame <= *state.frame) {
        throw InputError({"frames to link are out of order", fmt::format("frame {}", frame),
                          fmt::format("a frame after {}", *state.frame), ""});
    }
    if (!errors.empty() && errors.size() != positions.size()) {
        throw InputError({fmt::format("frame {} cannot be linked", frame),
                          fmt::format("{} errors", errors.size()),
                          fmt::format("none or {}, one a particle", positions.size()), ""});
    }
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (!is_finite(positions[i])) {
            throw InputError(
                {fmt::format("frame {} cannot be linked", frame),
                 fmt::format("particle {} at ({}, {})", i, positions[i].x, positions[i].y),
                 "finite positions", ""});
        }
    }
}

bool is_error(double e) {
    return std::isfinite(e) && e >= 0;
}

/// Mean square of the usable components; 0 if there is none.
double mean_square(const std::vector<Vec2>& errors) {
    double sum = 0;
    std::int64_t count = 0;
    for (const Vec2 e : errors) {
        for (const double c : {e.x, e.y}) {
            if (!is_error(c)) continue;
            sum += c * c;
            ++count;
        }
    }
    return count == 0 ? 0 : sum / static_cast<double>(count);
}

/// One position that is not known at all must not tip the scale for the others.
std::vector<Vec2> usable(std::vector<Vec2> errors, double most) {
    const auto bound = [&](double e) { return std::isfinite(e) ? std::min(e, most) : e; };
    for (Vec2& e : errors) e = {bound(e.x), bound(e.y)};
    const double typical = std::sqrt(mean_square(errors));
    for (Vec2& e : errors) {
        if (!is_error(e.x)) e.x = typical;
        if (!is_error(e.y)) e.y = typical;
    }
    return errors;
}

/// By how much errors enter the steps, at most 1. What an image model gets wrong about a sphere it
/// gets wrong in the next frame too: such an error is no part of a step. If the median of
/// |step|²/(e_track² + e_particle²) to the nearest track is below that of errors alone, 2 ln 2, the
/// errors are that much less.
double share_in_steps(const Places& from, const Places& to, double range) {
    if (from.error.empty() || to.error.empty() || from.position.empty()) return 1;
    const PointGrid grid(from.position, range);
    const std::size_t stride = (to.position.size() - 1) / kStepSample + 1;
    std::vector<double> ratio;
    for (std::size_t i = 0; i < to.position.size(); i += stride) {
        double nearest = range * range;
        double errors = 0;
        grid.near(to.position[i], range, [&](std::uint32_t t, Vec2 p) {
            const double squared = squared_norm(p - to.position[i]);
            if (squared >= nearest) return;
            nearest = squared;
            errors = 0.5 * (squared_norm(from.error[t]) + squared_norm(to.error[i]));
        });
        if (errors > 0) ratio.push_back(nearest / errors);
    }
    if (ratio.empty()) return 1;
    const auto middle = ratio.begin() + static_cast<std::ptrdiff_t>(ratio.size() / 2);
    std::nth_element(ratio.begin(), middle, ratio.end());
    return std::min(1.0, std::sqrt(*middle / (2 * std::numbers::ln2)));
}

}  // namespace

OptionTable describe(LinkOptions& options) {
    OptionTable table("link");
    table.number("search-range", options.search_range, "px", {1e-6, 1e5},
                 "largest step between two frames; auto: D/2 to D, as the motion asks");
    table.integer("memory", options.memory, "frames", {0, 100000},
                  "how long a sphere may be missing and keep its identity");
    table.choice("predictor", options.predictor,
                 {{"none", Predictor::none},
                  {"nearest-velocity", Predictor::nearest_velocity},
                  {"drift", Predictor::drift}},
                 "where a sphere is looked for: where it was, moved on with its own velocity, or "
                 "moved on with all others");
    table.integer("minimum-length", options.minimum_length, "frames", {1, 100000},
                  "leave out tracks of spheres seen in fewer frames");
    table.integer("largest-subnet", options.largest_subnet, "pairs", {1, 1e7},
                  "ambiguous groups up to this size are solved exactly, larger ones are cut");
    return table;
}

Linker::Linker(const LinkOptions& options, double diameter)
    : options_(options),
      least_range_(options.search_range.value_or(diameter / 2)),
      most_range_(options.search_range.value_or(diameter)) {
    if (!(least_range_ > 0) || !std::isfinite(least_range_)) {
        throw OptionError({"link.search-range is not usable", fmt::format("{} px", least_range_),
                           "a positive length", ""});
    }
}

void Linker::forget(std::int64_t frame) {
    const auto lost = [&](const Track& track) { return frame - track.frame > options_.memory + 1; };
    state_.summary.ended += static_cast<std::int64_t>(std::erase_if(state_.tracks, lost));
}

double Linker::range_for(double motion, double squared_error) const {
    return std::clamp(kReach * std::sqrt(motion + 2 * squared_error), least_range_, most_range_);
}

Linker::Choice Linker::choose(std::int64_t frame, const Places& predicted, const Places& particles,
                              double range) const {
    const std::vector<Track>& tracks = state_.tracks;
    StepCost cost;
    if (!particles.error.empty() && state_.motion > 0) {
        cost = {.motion = state_.motion, .squared_error = mean_square(particles.error)};
    }
    Choice choice;
    choice.range = range;
    choice.candidates = find_candidates(predicted, particles, range, cost);
    choice.links = choose_links(choice.candidates.pairs, static_cast<std::uint32_t>(tracks.size()),
                                static_cast<std::uint32_t>(particles.position.size()),
                                range * range, options_.largest_subnet, choice.counts);
    std::vector<SeenStep> steps;
    for (std::size_t t = 0; t < tracks.size(); ++t) {
        if (choice.links[t] < 0 || tracks[t].frame != frame - 1) continue;
        const auto p = static_cast<std::size_t>(choice.links[t]);
        steps.push_back(
            {squared_norm(particles.position[p] - predicted.position[t]),
             0.5 * (squared_norm(predicted.error_of(t)) + squared_norm(particles.error_of(p)))});
    }
    const double least = kLeastMotion * range;
    if (!steps.empty()) choice.motion = std::max(motion_variance(steps), least * least);
    return choice;
}

/// Whether more tracks that were left alone lie near a particle that was left alone than so many
/// independent points would: the difference stepped farther than the range. Near: within the
/// largest range, or, of a track that would make its last step again, within a quarter of it, where
/// chance puts few. Where particles come and go, at the border of the field, chance is that of
/// points along its perimeter.
bool Linker::has_long_steps(std::int64_t frame, const Choice& choice, const Places& predicted,
                            const Places& particles) const {
    std::vector<char> is_linked(particles.position.size(), 0);
    for (const std::int32_t p : choice.links) {
        if (p >= 0) is_linked[static_cast<std::size_t>(p)] = 1;
    }
    std::vector<Vec2> fresh;
    for (std::size_t i = 0; i < is_linked.size(); ++i) {
        if (!is_linked[i]) fresh.push_back(particles.position[i]);
    }
    if (fresh.empty()) return false;
    Vec2 low = particles.position[0];
    Vec2 high = low;
    for (const Vec2 p : particles.position) {
        low = {std::min(low.x, p.x), std::min(low.y, p.y)};
        high = {std::max(high.x, p.x), std::max(high.y, p.y)};
    }
    std::vector<Vec2> stays;
    std::vector<Vec2> goes_on;
    for (std::size_t t = 0; t < choice.links.size(); ++t) {
        const Track& track = state_.tracks[t];
        if (choice.links[t] >= 0 || track.frame != frame - 1) continue;
        stays.push_back(predicted.position[t]);
        if (track.velocity) goes_on.push_back(track.position + *track.velocity);
    }
    const auto are_near = [&](const std::vector<Vec2>& lost, double r) {
        const auto is_outer = [&](Vec2 p) {
            return p.x < low.x + r || p.x > high.x - r || p.y < low.y + r || p.y > high.y - r;
        };
        const PointGrid grid(fresh, r);
        const auto paired = static_cast<double>(std::ranges::count_if(lost, [&](Vec2 from) {
            bool near = false;
            grid.around(from,
                        [&](std::uint32_t, Vec2 p) { near |= squared_norm(p - from) <= r * r; });
            return near;
        }));
        const auto pairs = static_cast<double>(lost.size() * fresh.size());
        const auto outer_pairs = static_cast<double>(std::ranges::count_if(lost, is_outer) *
                                                     std::ranges::count_if(fresh, is_outer));
        const Vec2 size = high - low + Vec2{r, r};
        const double chance = pairs * std::numbers::pi * r * r / (size.x * size.y) +
                              outer_pairs * r / (size.x + size.y);
        return paired > chance + 5 * std::sqrt(chance);
    };
    return are_near(stays, most_range_) || are_near(goes_on, 0.25 * most_range_);
}

std::vector<std::int64_t> Linker::link(std::int64_t frame, const std::vector<Vec2>& positions,
                                       const std::vector<Vec2>& given_errors) {
    require_linkable(state_, frame, positions, given_errors);
    std::vector<Vec2> errors = usable(given_errors, least_range_);
    forget(frame);
    std::vector<Track>& tracks = state_.tracks;
    const std::vector<Vec2> predicted =
        predict(tracks, frame, options_.predictor, state_.drift, least_range_);
    std::vector<Vec2> track_errors;
    if (!errors.empty()) {
        for (const Track& track : tracks) track_errors.push_back(track.error);
    }
    const std::vector<Vec2> whole_errors = errors;
    const Places whole{positions, whole_errors};
    const Places from{predicted, track_errors};
    const Places to{positions, errors};
    const double share = share_in_steps(from, to, least_range_);
    for (Vec2& e : track_errors) e *= share;
    for (Vec2& e : errors) e *= share;
    const double squared_error = mean_square(errors);
    Choice choice = choose(frame, from, to, range_for(state_.motion, squared_error));
    const double wanted = range_for(choice.motion, squared_error);
    if (wanted > kWorthwhile * choice.range) choice = choose(frame, from, to, wanted);
    if (most_range_ > kWorthwhile * choice.range && has_long_steps(frame, choice, from, to)) {
        choice = choose(frame, from, to, most_range_);
    }

    std::vector<std::int64_t> ids(positions.size(), -1);
    for (std::size_t t = 0; t < tracks.size(); ++t) {
        const std::int32_t p = choice.links[t];
        if (p >= 0) ids[static_cast<std::size_t>(p)] = tracks[t].id;
    }
    state_.summary.crowded += choice.candidates.crowded_tracks;
    state_.summary.subnets.add(choice.counts);
    count_rivals(frame, choice, ids);
    follow(frame, choice, from, whole);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (ids[i] >= 0) continue;
        ids[i] = state_.next_id++;
        tracks.push_back({ids[i], frame, positions[i], whole.error_of(i), std::nullopt});
        ++state_.summary.started;
    }
    if (choice.motion > 0) state_.motion = choice.motion;
    state_.frame = frame;
    return ids;
}

void Linker::follow(std::int64_t frame, const Choice& choice, const Places& predicted,
                    const Places& particles) {
    LinkSummary& summary = state_.summary;
    summary.range = choice.range;
    std::vector<Vec2> velocities;
    for (std::size_t t = 0; t < choice.links.size(); ++t) {
        if (choice.links[t] < 0) continue;
        const auto p = static_cast<std::size_t>(choice.links[t]);
        Track& track = state_.tracks[t];
        const Vec2 step = particles.position[p] - track.position;
        const std::int64_t frames = frame - track.frame;
        ++summary.linked;
        if (frames > 1) {
            ++summary.bridged;
            summary.bridged_frames += frames - 1;
        } else {
            ++summary.consecutive;
            summary.squared_steps += squared_norm(step);
            summary.squared_misses += squared_norm(particles.position[p] - predicted.position[t]);
        }
        track.velocity = step * (1.0 / static_cast<double>(frames));
        track.position = particles.position[p];
        track.error = particles.error_of(p);
        track.frame = frame;
        if (options_.predictor != Predictor::none) velocities.push_back(*track.velocity);
    }
    if (!velocities.empty()) state_.drift = median(std::move(velocities));
}

void Linker::count_rivals(std::int64_t frame, const Choice& choice,
                          const std::vector<std::int64_t>& ids) {
    const std::vector<AssignmentPair>& pairs = choice.candidates.pairs;
    std::vector<char> split(ids.size(), 0);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const std::uint32_t track = pairs[k].row;
        // Every particle in reach of a track left alone is taken, or it would have been linked.
        const bool first = k == 0 || pairs[k - 1].row != track;
        if (first && choice.links[track] < 0 && state_.tracks[track].frame == frame - 1) {
            ++state_.summary.merged;
        }
        if (ids[pairs[k].column] < 0) split[pairs[k].column] = 1;
    }
    state_.summary.split += std::count(split.begin(), split.end(), 1);
}

std::vector<std::string> Linker::warnings(double diameter) const {
    const LinkSummary& s = state_.summary;
    std::vector<std::string> texts;
    if (s.consecutive > 0) {
        const double miss = std::sqrt(s.squared_misses / static_cast<double>(s.consecutive));
        if (miss > 0.25 * diameter) {
            texts.push_back(fmt::format(
                "spheres are {:.2f} px (RMS) from where they were looked for, more than a quarter "
                "of their diameter {:.2f} px: identities are doubtful; use a higher frame rate",
                miss, diameter));
        } else if (miss > 0.5 * s.range) {
            texts.push_back(fmt::format(
                "spheres are {:.2f} px (RMS) from where they were looked for, more than half the "
                "search range {:.2f} px, so that many are lost: link.search-range is too small",
                miss, s.range));
        }
    }
    if (s.subnets.reduced > 0) {
        texts.push_back(fmt::format(
            "{} ambiguous groups had more than {} pairs (the largest {}) and were cut before they "
            "were linked: identities there are doubtful: link.search-range is too large",
            s.subnets.reduced, options_.largest_subnet, s.subnets.largest_pairs));
    }
    if (s.crowded > 0) {
        texts.push_back(fmt::format(
            "{} times a track had more than 32 particles within the search range {:.2f} px and the "
            "32 nearest were considered: link.search-range is too large",
            s.crowded, s.range));
    }
    return texts;
}

}  // namespace grainfield::tracking
