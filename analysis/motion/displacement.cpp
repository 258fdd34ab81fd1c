#include "analysis/motion/displacement.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "analysis/motion/msd_result.h"
#include "analysis/motion/pair_sums.h"
#include "analysis/motion/van_hove.h"
#include "analysis/recorded_options.h"
#include "analysis/statistics/blocks.h"
#include "core/errors.h"
#include "core/support/parallel.h"

namespace grainfield::analysis {
namespace {

constexpr double absent = std::numeric_limits<double>::quiet_NaN();
constexpr int most_parts = 10;     // of the median time between frames
constexpr double tolerance = 0.1;  // of a lag time

// Of frame numbers, from one that was measured to the next; 1 of a single frame.
double median_gap(std::vector<std::int64_t> frames) {
    std::ranges::sort(frames);
    std::vector<double> gaps;
    for (std::size_t i = 1; i < frames.size(); ++i) {
        if (frames[i] > frames[i - 1]) {
            gaps.push_back(static_cast<double>(frames[i] - frames[i - 1]));
        }
    }
    if (gaps.empty()) return 1;
    const auto middle = gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2);
    std::ranges::nth_element(gaps, middle);
    return *middle;
}

}  // namespace

OptionTable describe(DisplacementOptions& options) {
    OptionTable table("msd");
    table.choice("lags", options.lags, {{"log", LagSpacing::logarithmic}, {"all", LagSpacing::all}},
                 "spacing of the lag times");
    table.integer("per-decade", options.per_decade, "-", {1, 1000},
                  "lag times a decade when spaced logarithmically");
    table.integer("longest", options.longest, "frames", {0, 1e12},
                  "longest lag time, in numbers of frames; 0: half the duration");
    table.integers("van-hove", options.van_hove, "frames", {1, 1e12},
                   "lags of the van Hove function in numbers of frames, as 1,10,100; empty: none");
    table.number("exposure", options.exposure, "time unit", {0, 1e12},
                 "exposure of a frame: the offset of the MSD then tells the localisation error");
    table.number("localisation", options.localisation, "a", {0, 1e3},
                 "localisation error per axis: the offset then tells the exposure; with both D is "
                 "fitted alone");
    table.number("memory", options.memory_mb, "MB", {1, 1e6},
                 "bound of the stored tracks; particles are left out beyond it");
    return table;
}

Displacement::Displacement(const DisplacementOptions& options, std::int64_t frames, int threads)
    : options_(options), expected_frames_(frames), threads_(threads) {
    for (const std::int64_t lag : options_.van_hove) {
        if (lag >= 1) continue;
        throw OptionError({.problem = "msd.van-hove holds something that is no lag",
                           .actual = std::to_string(lag),
                           .expected = "whole numbers of frames from 1 on",
                           .suggestion = {}});
    }
}

void Displacement::place(Track& track, std::size_t ordinal, Vec2 step) {
    const std::size_t at = ordinal - track.first;
    if (at >= track.step.capacity()) {
        // Doubling, but never beyond the last frame that can come.
        const auto expected = static_cast<std::size_t>(std::max<std::int64_t>(expected_frames_, 0));
        const std::size_t most = expected > track.first ? expected - track.first : 0;
        const std::size_t doubled = std::max<std::size_t>(8, 2 * track.step.capacity());
        const std::size_t wanted = std::max(at + 1, std::min(doubled, std::max(most, at + 1)));
        stored_ -= track.step.capacity();
        track.step.reserve(wanted);
        stored_ += track.step.capacity();
    }
    track.step.resize(at, {absent, absent});
    track.step.push_back(step);
}

void Displacement::add(const Pattern& pattern) {
    const std::size_t ordinal = frame_.size();
    frame_.push_back(pattern.frame);
    time_.push_back(pattern.time);
    box_ = pattern.box;
    if (pattern.id.empty() && pattern.size() > 0) linked_ = false;
    index_.start_frame();
    for (std::size_t i = 0; i < pattern.id.size(); ++i) {
        const std::int64_t id = pattern.id[i];
        if (id < 0 || (thinning_ != 0 && (identity_hash(id) & thinning_) != 0)) continue;
        const Vec2 p = pattern.position[i];
        const auto [at, is_new] = index_.place_of(id, tracks_.size());
        if (is_new) tracks_.push_back({id, ordinal, p, {0, 0}, p, {}});
        Track& track = tracks_[at];
        if (track.first + track.step.size() > ordinal)
            continue;  // identity given twice: first wins
        track.moved += box_.minimum_image(p - track.last);
        track.last = p;
        place(track, ordinal, track.moved);
    }
    if (static_cast<double>(stored_) * sizeof(Vec2) > options_.memory_mb * 1e6) thin_out();
}

void Displacement::thin_out() {
    thinning_ = 2 * thinning_ + 1;
    drop_left_out();
}

void Displacement::drop_left_out() {
    std::erase_if(tracks_,
                  [this](const Track& t) { return (identity_hash(t.id) & thinning_) != 0; });
    index_.clear();
    stored_ = 0;
    for (std::size_t t = 0; t < tracks_.size(); ++t) {
        index_.place_of(tracks_[t].id, t);
        stored_ += tracks_[t].step.capacity();
    }
}

void Displacement::merge(const Displacement& later) {
    const std::size_t offset = frame_.size();
    frame_.insert(frame_.end(), later.frame_.begin(), later.frame_.end());
    time_.insert(time_.end(), later.time_.begin(), later.time_.end());
    linked_ = linked_ && later.linked_;
    box_ = later.box_;
    expected_frames_ = std::max(expected_frames_, static_cast<std::int64_t>(frame_.size()));
    thinning_ = std::max(thinning_, later.thinning_);
    for (const Track& from : later.tracks_) {
        if ((identity_hash(from.id) & thinning_) != 0) continue;
        const std::size_t ordinal = offset + from.first;
        const auto [at, is_new] = index_.place_of(from.id, tracks_.size());
        if (is_new) tracks_.push_back({from.id, ordinal, from.origin, {0, 0}, from.origin, {}});
        Track& track = tracks_[at];
        const Vec2 start = track.moved + box_.minimum_image(from.origin - track.last);
        for (std::size_t i = 0; i < from.step.size(); ++i) {
            if (is_finite(from.step[i])) place(track, ordinal + i, start + from.step[i]);
        }
        track.moved = start + from.moved;
        track.last = from.last;
    }
    drop_left_out();
}

// The time stamps on an even grid. The step is the median time from stamp to stamp, or the largest
// whole part of it, down to a tenth, that fits every one of them within a tenth of itself. Then
// all pairs of frames that lie the same number of steps apart also lie the same time apart within a
// tenth, however long the run. Stamps may go back; two frames at one time share a slot.
std::optional<Displacement::Clock> Displacement::clock() const {
    std::vector<double> stamp = time_;
    std::ranges::sort(stamp);
    stamp.erase(std::unique(stamp.begin(), stamp.end()), stamp.end());
    if (stamp.size() < 2 || !std::isfinite(stamp.back() - stamp.front())) return std::nullopt;
    std::vector<double> gap;
    for (std::size_t i = 1; i < stamp.size(); ++i) gap.push_back(stamp[i] - stamp[i - 1]);
    std::vector<double> sorted = gap;
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    const double median = *middle;

    for (int parts = 1; parts <= most_parts; ++parts) {
        Clock clock;
        clock.step = median / parts;
        clock.parts = parts;
        clock.per_frame = parts / median_gap(frame_);
        std::vector<std::size_t> slot{0};
        bool fits = true;
        for (double g : gap) {
            const double steps = std::max(1.0, std::round(g / clock.step));
            fits = fits && std::abs(g - steps * clock.step) <= tolerance * steps * clock.step;
            if (!fits || steps > 1e9) break;
            slot.push_back(slot.back() + static_cast<std::size_t>(steps));
        }
        if (!fits || slot.size() != stamp.size()) continue;
        clock.slots = slot.back() + 1;
        if (clock.slots > 20 * frame_.size() + 100) continue;
        for (double t : time_) {
            const auto at = std::ranges::lower_bound(stamp, t) - stamp.begin();
            clock.slot.push_back(slot[static_cast<std::size_t>(at)]);
        }
        return clock;
    }
    return std::nullopt;
}

std::vector<std::size_t> Displacement::lags(const Clock& clock) const {
    std::size_t longest = std::max<std::size_t>(1, (clock.slots - 1) / 2);
    if (options_.longest > 0) {
        const auto slots = static_cast<double>(clock.slots - 1);
        const double asked = static_cast<double>(options_.longest) * clock.per_frame;
        longest = static_cast<std::size_t>(std::clamp(std::floor(asked + 1e-9), 1.0, slots));
    }
    std::vector<std::size_t> lags;
    if (options_.lags == LagSpacing::all) {
        lags.resize(longest);
        std::iota(lags.begin(), lags.end(), std::size_t{1});
        return lags;
    }
    for (int step = 0;; ++step) {
        const double wanted = std::pow(10.0, static_cast<double>(step) / options_.per_decade);
        const auto lag = static_cast<std::size_t>(std::lround(wanted));
        if (lag >= longest) break;
        if (lags.empty() || lag > lags.back()) lags.push_back(lag);
    }
    lags.push_back(longest);
    return lags;
}

std::vector<double> Displacement::lag_times(const Clock& clock,
                                            const std::vector<std::size_t>& lags) const {
    std::vector<double> at(clock.slots, absent);
    for (std::size_t i = 0; i < time_.size(); ++i) at[clock.slot[i]] = time_[i];
    std::vector<double> times;
    for (std::size_t lag : lags) {
        double sum = 0;
        double count = 0;
        for (std::size_t s = 0; s + lag < clock.slots; ++s) {
            const double difference = at[s + lag] - at[s];
            if (!std::isfinite(difference)) continue;
            sum += difference;
            count += 1;
        }
        times.push_back(count > 0 ? sum / count : absent);
    }
    return times;
}

void Displacement::add_track(const Track& track, const Clock& clock,
                             const std::vector<std::size_t>& lags, const PhaseHistory* phases,
                             Sums& sums) const {
    if (track.step.size() < 2) return;
    const auto from = clock.slot.begin() + static_cast<std::ptrdiff_t>(track.first);
    const auto [lowest, highest] =
        std::minmax_element(from, from + static_cast<std::ptrdiff_t>(track.step.size()));
    const std::size_t start = *lowest;
    const std::size_t length = *highest - start + 1;
    std::vector<double> x(length, 0.0);
    std::vector<double> y(length, 0.0);
    std::vector<double> seen(length, 0.0);
    std::vector<Phase> phase(length, Phase::unknown);
    std::int64_t first_window = 0;
    const std::span<const Phase> history =
        phases != nullptr ? phases->classes(track.id, first_window) : std::span<const Phase>();
    bool gaps = false;
    for (std::size_t i = 0; i < track.step.size(); ++i) {
        if (!is_finite(track.step[i])) continue;
        const std::size_t slot = clock.slot[track.first + i] - start;
        if (seen[slot] > 0) continue;
        x[slot] = track.step[i].x;
        y[slot] = track.step[i].y;
        seen[slot] = 1;
        if (history.empty()) continue;
        const std::int64_t window = clock.window[track.first + i] - first_window;
        if (window >= 0 && window < static_cast<std::int64_t>(history.size())) {
            phase[slot] = history[static_cast<std::size_t>(window)];
        }
    }
    for (std::size_t s = 0; s < length; ++s) {
        if (seen[s] > 0) continue;
        gaps = true;
        if (s > 0) phase[s] = phase[s - 1];  // carries no weight; keeps the runs long
    }

    struct Stretch {
        std::size_t from, to;
        Phase phase;
    };
    std::vector<Stretch> stretches;
    for (std::size_t s = 0; s < length; ++s) {
        if (s > 0 && phase[s] == phase[s - 1]) continue;
        if (s > 0) stretches.back().to = s;
        stretches.push_back({s, length, phase[s]});
    }

    std::array<bool, classes> has_pairs{};
    for (std::size_t l = 0; l < lags.size() && lags[l] < length; ++l) {
        const std::size_t lag = lags[l];
        for (const Stretch& stretch : stretches) {
            const std::size_t to = std::min(stretch.to, length - lag);
            if (stretch.from >= to) break;
            double pairs = gaps ? 0 : static_cast<double>(to - stretch.from);
            const double sum = gaps ? sum_squared_steps_masked(x.data(), y.data(), seen.data(),
                                                               stretch.from, to, lag, pairs)
                                    : sum_squared_steps(x.data(), y.data(), stretch.from, to, lag);
            const auto add_to = [&](std::size_t which) {
                sums.lags[l].sum[which] += sum;
                sums.lags[l].pairs[which] += pairs;
                has_pairs[which] = has_pairs[which] || pairs > 0;
            };
            add_to(0);
            if (stretch.phase == Phase::liquid) add_to(1);
            if (stretch.phase == Phase::solid) add_to(2);
        }
    }
    for (std::size_t c = 0; c < classes; ++c) sums.particles[c] += has_pairs[c] ? 1 : 0;
}

ObservableResult Displacement::result(const PhaseHistory* phases) const {
    ObservableResult result;
    result.name = "msd";
    DisplacementOptions options = options_;
    result.options = recorded(describe(options));
    if (frame_.size() < 2) {
        result.reason = frame_.empty() ? "no frames" : "one frame: nothing has moved yet";
        return result;
    }
    if (!linked_) {
        result.reason = "the particles are not linked from frame to frame";
        return result;
    }
    for (std::size_t i = 1; i < frame_.size(); ++i) {
        if (frame_[i] > frame_[i - 1]) continue;
        result.reason = "the frame indices do not increase";
        return result;
    }
    std::optional<Clock> clock = this->clock();
    if (!clock) {
        result.reason = fmt::format(
            "the time stamps lie too unevenly: no part of their median interval down to 1/{} fits "
            "them within {:.0f} %",
            most_parts, 100 * tolerance);
        return result;
    }
    const WindowRule rule = phases != nullptr ? phases->rule() : WindowRule{};
    for (double t : time_) {
        const std::int64_t window = phases != nullptr ? phases->window_of(t) : -1;
        const bool counts = window >= 0 && !rule.is_short(phases->frames_in(window));
        clock->window.push_back(counts ? window : -1);
    }
    const std::vector<std::size_t> lags = this->lags(*clock);
    std::vector<Sums> sums(groups, Sums{std::vector<LagSums>(lags.size()), {}});
    parallel_for(groups, threads_, [&](std::int64_t group) {
        const auto g = static_cast<std::size_t>(group);
        for (const Track& track : tracks_) {
            if ((identity_hash(track.id) >> 56) % groups != g) continue;
            add_track(track, *clock, lags, phases, sums[g]);
        }
    });

    MsdTable table;
    table.time = lag_times(*clock, lags);
    for (std::size_t c = 0; c < classes; ++c) {
        MsdTable::Series& series = table.series[c];
        for (std::size_t g = 0; g < groups; ++g) {
            series.sum.emplace_back();
            series.pairs.emplace_back();
            table.particles[c] += sums[g].particles[c];
            for (const LagSums& lag : sums[g].lags) {
                series.sum.back().push_back(lag.sum[c]);
                series.pairs.back().push_back(lag.pairs[c]);
            }
        }
    }
    table.has_phases = phases != nullptr;
    table.exposure = options_.exposure;
    table.localisation = options_.localisation;
    if (clock->parts > 1) {
        table.note = fmt::format(
            "uneven time stamps: lag times in steps of 1/{} of the median interval, each within "
            "{:.0f} %",
            clock->parts, 100 * tolerance);
    }
    if (thinning_ != 0) {
        if (!table.note.empty()) table.note += "; ";
        table.note += fmt::format("one particle in {} kept to stay within {:.0f} MB", thinning_ + 1,
                                  options_.memory_mb);
    }
    add_msd(table, result);
    if (!options_.van_hove.empty()) add_van_hove(*clock, result);
    return result;
}

}  // namespace grainfield::analysis
