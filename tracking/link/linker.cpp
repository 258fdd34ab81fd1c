#include "tracking/link/linker.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::tracking {
namespace {

/// The least motion that weights assume [search range]: a video that stands still must not make
/// differences in precision decide alone.
constexpr double kLeastMotion = 0.01;

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

/// Median square of the usable components; 0 if there is none.
double median_square(const std::vector<Vec2>& errors) {
    std::vector<double> squares;
    for (const Vec2 e : errors) {
        if (is_error(e.x)) squares.push_back(e.x * e.x);
        if (is_error(e.y)) squares.push_back(e.y * e.y);
    }
    if (squares.empty()) return 0;
    const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(squares.size() / 2);
    std::nth_element(squares.begin(), middle, squares.end());
    return *middle;
}

std::vector<Vec2> usable(std::vector<Vec2> errors) {
    const double typical = std::sqrt(median_square(errors));
    for (Vec2& e : errors) {
        if (!is_error(e.x)) e.x = typical;
        if (!is_error(e.y)) e.y = typical;
    }
    return errors;
}

}  // namespace

OptionTable describe(LinkOptions& options) {
    OptionTable table("link");
    table.number("search-range", options.search_range, "px", {1e-6, 1e5},
                 "largest step between two frames; auto: half the apparent diameter");
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

Linker::Linker(const LinkOptions& options)
    : options_(options), range_(options.search_range.value_or(0)) {
    if (!(range_ > 0) || !std::isfinite(range_)) {
        throw OptionError({"link.search-range is not usable", fmt::format("{} px", range_),
                           "a positive length", "give --search-range"});
    }
}

void Linker::forget(std::int64_t frame) {
    const auto lost = [&](const Track& track) { return frame - track.frame > options_.memory + 1; };
    state_.summary.ended += static_cast<std::int64_t>(std::erase_if(state_.tracks, lost));
}

StepCost Linker::step_cost(const std::vector<Vec2>& errors) const {
    StepCost cost;
    if (errors.empty() || state_.motion <= 0) return cost;
    cost.motion = state_.motion;
    cost.squared_error = median_square(errors);
    return cost;
}

std::vector<std::int64_t> Linker::link(std::int64_t frame, const std::vector<Vec2>& positions,
                                       const std::vector<Vec2>& given_errors) {
    require_linkable(state_, frame, positions, given_errors);
    const std::vector<Vec2> errors = usable(given_errors);
    forget(frame);
    std::vector<Track>& tracks = state_.tracks;
    LinkSummary& summary = state_.summary;

    const std::vector<Vec2> predicted =
        predict(tracks, frame, options_.predictor, state_.drift, range_);
    std::vector<Vec2> track_errors;
    if (!errors.empty()) {
        for (const Track& track : tracks) track_errors.push_back(track.error);
    }
    const Candidates candidates =
        find_candidates({predicted, track_errors}, {positions, errors}, range_, step_cost(errors));
    summary.crowded += candidates.crowded_tracks;
    SubnetCounts counts;
    const std::vector<std::int32_t> links =
        choose_links(candidates.pairs, static_cast<std::uint32_t>(tracks.size()),
                     static_cast<std::uint32_t>(positions.size()), range_ * range_,
                     options_.largest_subnet, counts);
    summary.subnets.add(counts);

    std::vector<std::int64_t> ids(positions.size(), -1);
    for (std::size_t t = 0; t < tracks.size(); ++t) {
        if (links[t] >= 0) ids[static_cast<std::size_t>(links[t])] = tracks[t].id;
    }
    count_rivals(frame, candidates.pairs, links, ids);
    std::vector<Vec2> velocities;
    std::vector<SeenStep> misses;
    for (std::size_t t = 0; t < tracks.size(); ++t) {
        if (links[t] < 0) continue;
        const auto p = static_cast<std::size_t>(links[t]);
        Track& track = tracks[t];
        const Vec2 step = positions[p] - track.position;
        const std::int64_t frames = frame - track.frame;
        ++summary.linked;
        if (frames > 1) {
            ++summary.bridged;
            summary.bridged_frames += frames - 1;
        } else {
            const double miss = squared_norm(positions[p] - predicted[t]);
            ++summary.consecutive;
            summary.squared_steps += squared_norm(step);
            summary.squared_misses += miss;
            if (!errors.empty()) {
                misses.push_back(
                    {miss, 0.5 * (squared_norm(track.error) + squared_norm(errors[p]))});
            }
        }
        track.velocity = step * (1.0 / static_cast<double>(frames));
        if (options_.predictor != Predictor::none) velocities.push_back(*track.velocity);
        track.position = positions[p];
        track.error = errors.empty() ? Vec2{} : errors[p];
        track.frame = frame;
    }
    learn(std::move(velocities), misses);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        if (ids[i] >= 0) continue;
        ids[i] = state_.next_id++;
        tracks.push_back(
            {ids[i], frame, positions[i], errors.empty() ? Vec2{} : errors[i], std::nullopt});
        ++summary.started;
    }
    state_.frame = frame;
    return ids;
}

void Linker::learn(std::vector<Vec2> velocities, const std::vector<SeenStep>& steps) {
    if (!velocities.empty()) state_.drift = median(std::move(velocities));
    if (steps.empty()) return;
    const double least = kLeastMotion * range_;
    state_.motion = std::max(motion_variance(steps), least * least);
}

void Linker::count_rivals(std::int64_t frame, const std::vector<AssignmentPair>& pairs,
                          const std::vector<std::int32_t>& links,
                          const std::vector<std::int64_t>& ids) {
    std::vector<char> split(ids.size(), 0);
    for (std::size_t k = 0; k < pairs.size(); ++k) {
        const std::uint32_t track = pairs[k].row;
        // Every particle in reach of a track left alone is taken, or it would have been linked.
        const bool first = k == 0 || pairs[k - 1].row != track;
        if (first && links[track] < 0 && state_.tracks[track].frame == frame - 1) {
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
        } else if (miss > 0.5 * range_) {
            texts.push_back(fmt::format(
                "spheres are {:.2f} px (RMS) from where they were looked for, more than half the "
                "search range {:.2f} px, so that many are lost; use a larger --search-range",
                miss, range_));
        }
    }
    if (s.subnets.reduced > 0) {
        texts.push_back(fmt::format(
            "{} ambiguous groups had more than {} pairs (the largest {}) and were cut before they "
            "were linked: identities there are doubtful; use a smaller --search-range",
            s.subnets.reduced, options_.largest_subnet, s.subnets.largest_pairs));
    }
    if (s.crowded > 0) {
        texts.push_back(fmt::format(
            "{} times a track had more than 32 particles within the search range {:.2f} px and the "
            "32 nearest were considered; use a smaller --search-range",
            s.crowded, range_));
    }
    return texts;
}

}  // namespace grainfield::tracking
