#include "analysis/order/phase.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "analysis/recorded_options.h"
#include "analysis/statistics/blocks.h"
#include "core/errors.h"

namespace grainfield::analysis {

OptionTable describe(PhaseOptions& options) {
    OptionTable table("phase");
    table.number("liquid-below", options.liquid_below, "-", {0, 1},
                 "largest time-averaged |Q4| of a liquid particle");
    table.number("solid-above", options.solid_above, "-", {0, 1},
                 "least time-averaged |Q4| of a solid particle");
    table.number("window", options.window, "time unit", {0, 1e12},
                 "averaging time; auto: 32 vibration periods, or 0.4 s");
    return table;
}

PhaseWindow PhaseWindow::of(const PhaseOptions& options, const TrajectoryInfo& info) {
    if (options.window && *options.window > 0) return {options.window, ""};
    if (options.window) return {std::nullopt, "averaging time 0: every frame classified alone"};
    if (info.vibration_frequency && *info.vibration_frequency > 0) {
        return {32 / *info.vibration_frequency, ""};
    }
    if (info.time_unit == TimeUnit::second) return {0.4, ""};
    return {std::nullopt,
            "neither vibration frequency nor seconds are known: every frame classified alone"};
}

PhaseHistory::PhaseHistory(const PhaseOptions& options, const TrajectoryInfo& info,
                           std::int64_t frames)
    : options_(options), window_(PhaseWindow::of(options, info)) {
    if (options.liquid_below > options.solid_above) {
        throw OptionError(ErrorText{"phase.liquid-below is above phase.solid-above",
                                    std::to_string(options.liquid_below),
                                    "at most " + std::to_string(options.solid_above), ""});
    }
    if (frames <= 1) window_ = {std::nullopt, "one frame: classified by |Q4| of this frame alone"};
}

Phase PhaseHistory::classify(double mean) const {
    if (!std::isfinite(mean)) return Phase::unknown;
    if (mean <= options_.liquid_below) return Phase::liquid;
    return mean >= options_.solid_above ? Phase::solid : Phase::between;
}

void PhaseHistory::count(Row& row, Phase phase) const {
    if (phase == Phase::unknown) return;
    row.all += 1;
    row.liquid += phase == Phase::liquid;
    row.solid += phase == Phase::solid;
}

// Place of a time on the grid of windows.
double PhaseHistory::key_of(double time) const {
    // A frame meant to start a window may be early by rounding.
    const double place = std::floor(time / *window_.length + 1e-9);
    // Beyond 2^53 windows are shorter than the digits of the time can tell apart.
    return std::abs(place) < 0x1p53 ? place : time;
}

std::int64_t PhaseHistory::window_of(double time) const {
    if (!window_.length) return -1;
    const auto at = windows_.find(key_of(time));
    return at == windows_.end() ? -1 : at->second;
}

// The class of a track in a window; windows of the past may be filled in later.
void PhaseHistory::note(Track& track, std::int64_t window, Phase phase) {
    if (track.classes.empty()) track.first_window = window;
    if (window < track.first_window) {
        track.classes.insert(track.classes.begin(),
                             static_cast<std::size_t>(track.first_window - window), Phase::unknown);
        track.first_window = window;
    }
    const auto place = static_cast<std::size_t>(window - track.first_window);
    if (track.classes.size() <= place) track.classes.resize(place + 1, Phase::unknown);
    track.classes[place] = phase;
}

void PhaseHistory::add_alone(const Sample& sample) {
    Row row{sample.frame, sample.time, 1, 0, 0, 0};
    for (float q : sample.abs_q) count(row, classify(static_cast<double>(q)));
    rows_.push_back(row);
}

void PhaseHistory::add(Sample sample) {
    ++frames_;
    if (!sample.abs_q.empty() && sample.id.empty() && window_.length) {
        window_ = {std::nullopt, "particles are not linked: every frame classified alone"};
    }
    if (!window_.length) return add_alone(sample);

    const double key = key_of(sample.time);
    if (open_frames_ > 0 && key != open_key_) close_window();
    if (open_frames_ == 0) {
        open_key_ = key;
        open_ = Row{sample.frame, sample.time, 0, 0, 0, 0};
    }
    ++open_frames_;
    index_.start_frame();
    for (std::size_t i = 0; i < sample.id.size(); ++i) {
        if (!std::isfinite(sample.abs_q[i])) continue;
        const auto [at, is_new] = index_.place_of(sample.id[i], tracks_.size());
        if (is_new) tracks_.emplace_back();
        Track& track = tracks_[at];
        if (track.count == 0) touched_.push_back(at);
        const auto q = static_cast<double>(sample.abs_q[i]);
        track.sum += q;
        track.squares += q * q;
        ++track.count;
    }
}

void PhaseHistory::close_window() {
    if (open_frames_ == 0) return;
    Row row = open_;
    row.frames = open_frames_;
    const auto next = static_cast<std::int64_t>(windows_.size());
    const std::int64_t window = windows_.try_emplace(open_key_, next).first->second;
    frames_in_.resize(windows_.size(), 0.0);
    frames_in_[static_cast<std::size_t>(window)] = row.frames;
    for (std::size_t t : touched_) {
        Track& track = tracks_[t];
        const Phase phase =
            2 * track.count >= open_frames_ ? classify(track.sum / track.count) : Phase::unknown;
        count(row, phase);
        note(track, window, phase);
        note_fluctuation(track);
        track.sum = 0;
        track.squares = 0;
        track.count = 0;
    }
    touched_.clear();
    open_frames_ = 0;
    rows_.push_back(row);
    if (std::ranges::any_of(open_spreads_, [](const Spread& s) { return s.count > 0; })) {
        spreads_.push_back(std::exchange(open_spreads_, {}));
    }
}

void PhaseHistory::note_fluctuation(const Track& track) {
    constexpr int least_sightings = 5;
    if (track.count < least_sightings) return;
    const double mean = track.sum / track.count;
    const double spread = std::sqrt(std::max(0.0, track.squares / track.count - mean * mean) *
                                    track.count / (track.count - 1));
    const auto bin = static_cast<std::size_t>(mean * spread_bins);
    Spread& sums = open_spreads_[std::min(bin, spread_bins - 1)];
    sums.sum += spread;
    sums.squares += spread * spread;
    sums.count += 1;
}

// Of the standard deviations in the bins from first to last, both included.
PhaseHistory::Fluctuation PhaseHistory::fluctuation(std::size_t first_bin,
                                                    std::size_t last_bin) const {
    std::vector<double> sum;
    std::vector<double> count;
    Spread all;
    for (const Spreads& window : spreads_) {
        Spread here;
        for (std::size_t b = first_bin; b <= last_bin; ++b) {
            here.sum += window[b].sum;
            here.count += window[b].count;
            all.squares += window[b].squares;
        }
        sum.push_back(here.sum);
        count.push_back(here.count);
        all.sum += here.sum;
        all.count += here.count;
    }
    Fluctuation f{all.sum / all.count, all.count, ratio_error(sum, count)};
    if (f.found.error) {
        const double variance = std::max(0.0, all.squares / all.count - f.mean * f.mean);
        const double error = *f.found.error;
        f.found.samples = std::clamp(variance / (error * error), 1.0, all.count);
    }
    return f;
}

void PhaseHistory::add_fluctuation(ObservableResult& result) const {
    const char* name = "q4_fluctuation";
    if (spreads_.empty()) {
        result.measurements.push_back(missing(
            name, "-", "no window in which a particle is seen five times: no fluctuation in time"));
        return;
    }
    constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
    Curve curve{name,
                "Fluctuation of the order of a particle",
                {{"m", "-", "Mean |Q4| in a window", {}},
                 {"sigma", "-", "Standard deviation of |Q4| in a window", {}},
                 {"err", "-", "Standard error", {}},
                 {"n", "-", "Particles and windows", {}},
                 {"samples", "-", "Independent particles and windows", {}}},
                {}};
    for (std::size_t b = 0; b < spread_bins; ++b) {
        const Fluctuation f = fluctuation(b, b);
        if (!(f.count >= 3)) continue;
        curve.columns[0].values.push_back((static_cast<double>(b) + 0.5) / spread_bins);
        curve.columns[1].values.push_back(f.mean);
        curve.columns[2].values.push_back(f.found.error.value_or(undefined));
        curve.columns[3].values.push_back(f.count);
        curve.columns[4].values.push_back(f.found.samples);
    }
    if (!curve.columns[0].values.empty()) result.curves.push_back(std::move(curve));
    const Fluctuation all = fluctuation(0, spread_bins - 1);
    result.measurements.push_back(
        {name, "-", all.mean, all.found.error, all.found.samples, all.found.reason});
}

void PhaseHistory::merge(const PhaseHistory& later) {
    close_window();
    PhaseHistory closed = later;
    closed.close_window();
    frames_ += closed.frames_;
    rows_.insert(rows_.end(), closed.rows_.begin(), closed.rows_.end());
    if (!closed.window_.length) window_ = closed.window_;
    spreads_.insert(spreads_.end(), closed.spreads_.begin(), closed.spreads_.end());
    std::map<std::int64_t, double> by_number;
    for (const auto& [key, number] : closed.windows_) by_number.emplace(number, key);
    std::vector<std::int64_t> here;  // our number of each of their windows
    for (const auto& [number, key] : by_number) {
        const auto next = static_cast<std::int64_t>(windows_.size());
        here.push_back(windows_.try_emplace(key, next).first->second);
        // Of a window that both have, the classes of the first part stay.
        if (here.back() == next) frames_in_.push_back(closed.frames_in(number));
    }
    for (const auto& [id, from] : closed.index_.all()) {
        const Track& source = closed.tracks_[from];
        const auto [at, is_new] = index_.place_of(id, tracks_.size());
        if (is_new) tracks_.emplace_back();
        Track& track = tracks_[at];
        for (std::size_t w = 0; w < source.classes.size(); ++w) {
            const std::int64_t window = here[static_cast<std::size_t>(source.first_window) + w];
            const std::int64_t place = window - track.first_window;
            const bool known = !track.classes.empty() && place >= 0 &&
                               place < static_cast<std::int64_t>(track.classes.size()) &&
                               track.classes[static_cast<std::size_t>(place)] != Phase::unknown;
            if (!known) note(track, window, source.classes[w]);
        }
    }
}

std::span<const Phase> PhaseHistory::classes(std::int64_t id, std::int64_t& first_window) const {
    const auto at = index_.all().find(id);
    if (at == index_.all().end() || !window_.length) return {};
    first_window = tracks_[at->second].first_window;
    return tracks_[at->second].classes;
}

double PhaseHistory::frames_in(std::int64_t window) const {
    const auto at = static_cast<std::size_t>(window);
    return window >= 0 && at < frames_in_.size() ? frames_in_[at] : 0;
}

WindowRule PhaseHistory::rule() const {
    if (!window_.length) return {};
    std::vector<double> frames;
    for (const Row& row : rows_) {
        if (row.all > 0) frames.push_back(row.frames);
    }
    if (frames.empty()) return {};
    const auto middle = frames.begin() + static_cast<std::ptrdiff_t>(frames.size() / 2);
    std::ranges::nth_element(frames, middle);
    return {0.5 * *middle};
}

// What limits the meaning of the fractions, means of so many windows; empty if nothing does.
std::string PhaseHistory::remark(std::size_t windows, std::size_t left_out) const {
    if (!window_.reason.empty()) return window_.reason;
    const bool averages = std::ranges::any_of(rows_, [](const Row& row) { return row.frames > 1; });
    if (!averages) {
        return fmt::format("no window of {:.4g} holds two frames: phase of one frame",
                           *window_.length);
    }
    std::string few =
        left_out == 0 ? "" : fmt::format("windows of few frames left out: {}", left_out);
    if (windows > 1) return few;
    return "one window: no error from fluctuations" + (few.empty() ? few : "; " + few);
}

ObservableResult PhaseHistory::result() const {
    if (open_frames_ > 0) {
        PhaseHistory closed = *this;
        closed.close_window();
        return closed.result();
    }
    ObservableResult result;
    result.name = "phase";
    PhaseOptions options = options_;
    result.options = recorded(describe(options));

    Curve curve;
    curve.name = "phase";
    curve.title = "Solid and liquid fraction";
    Column frame{"frame", "-", "Frame", {}};
    Column time{"t", "time unit", "Time", {}};
    Column solid{"solid_fraction", "-", "Solid fraction", {}};
    Column liquid{"liquid_fraction", "-", "Liquid fraction", {}};
    MeanSeries solid_mean;
    MeanSeries liquid_mean;
    const WindowRule rule = this->rule();
    std::size_t left_out = 0;
    for (const Row& row : rows_) {
        if (row.all <= 0) continue;
        if (rule.is_short(row.frames)) {
            ++left_out;
            continue;
        }
        frame.values.push_back(static_cast<double>(row.frame));
        time.values.push_back(row.time);
        solid.values.push_back(row.solid / row.all);
        liquid.values.push_back(row.liquid / row.all);
        solid_mean.add(row.solid / row.all);
        liquid_mean.add(row.liquid / row.all);
    }
    if (solid_mean.value.empty()) {
        result.reason = frames_ == 0 ? "no frames" : "no particle has a defined |Q4|";
        return result;
    }
    curve.columns = {frame, time, solid, liquid};
    result.curves = {curve};
    const std::string why = remark(solid_mean.value.size(), left_out);
    for (auto& [name, mean] :
         {std::pair{"solid_fraction", &solid_mean}, std::pair{"liquid_fraction", &liquid_mean}}) {
        Measurement m = mean->measurement(name, "-", std::nullopt, why);
        if (!why.empty() && m.reason != why) m.reason += (m.reason.empty() ? "" : "; ") + why;
        result.measurements.push_back(m);
    }
    add_fluctuation(result);
    if (window_.length) {
        double frames = 0;
        for (const Row& row : rows_) frames += row.frames;
        result.measurements.push_back({"averaging_time", "time unit", window_.length, std::nullopt,
                                       0,
                                       fmt::format("chosen, not measured; {:.3g} frames in it",
                                                   frames / static_cast<double>(rows_.size()))});
    } else {
        result.measurements.push_back(missing("averaging_time", "time unit", window_.reason));
    }
    return result;
}

}  // namespace grainfield::analysis
