#include "analysis/phase.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "analysis/blocks.h"
#include "analysis/bond_statistics.h"
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

std::int64_t PhaseHistory::window_of(double time) const {
    if (!window_.length) return 0;
    // A frame meant to start a window may be early by rounding.
    return static_cast<std::int64_t>(std::floor(time / *window_.length + 1e-9));
}

void PhaseHistory::add_alone(const Sample& sample) {
    Row row{sample.frame, 0, 0, 0};
    for (float q : sample.abs_q) count(row, classify(static_cast<double>(q)));
    rows_.push_back(row);
}

void PhaseHistory::add(Sample sample) {
    ++frames_;
    if (!sample.abs_q.empty() && sample.id.empty() && window_.length) {
        window_ = {std::nullopt, "particles are not linked: every frame classified alone"};
    }
    if (!window_.length) return add_alone(sample);

    const std::int64_t window = window_of(sample.time);
    if (open_frames_ > 0 && window != open_window_) close_window();
    if (open_frames_ == 0) {
        open_window_ = window;
        open_frame_ = sample.frame;
    }
    ++open_frames_;
    for (std::size_t i = 0; i < sample.id.size(); ++i) {
        if (!std::isfinite(sample.abs_q[i])) continue;
        const auto [at, is_new] = index_.try_emplace(sample.id[i], tracks_.size());
        if (is_new) tracks_.emplace_back();
        Track& track = tracks_[at->second];
        if (track.count == 0) touched_.push_back(at->second);
        track.sum += static_cast<double>(sample.abs_q[i]);
        ++track.count;
    }
}

void PhaseHistory::close_window() {
    if (open_frames_ == 0) return;
    Row row{open_frame_, 0, 0, 0};
    for (std::size_t t : touched_) {
        Track& track = tracks_[t];
        const Phase phase =
            2 * track.count >= open_frames_ ? classify(track.sum / track.count) : Phase::unknown;
        count(row, phase);
        if (track.classes.empty()) track.first_window = open_window_;
        if (open_window_ < track.first_window) {  // time stamps may go back
            track.classes.insert(track.classes.begin(),
                                 static_cast<std::size_t>(track.first_window - open_window_),
                                 Phase::unknown);
            track.first_window = open_window_;
        }
        const auto place = static_cast<std::size_t>(open_window_ - track.first_window);
        if (track.classes.size() <= place) track.classes.resize(place + 1, Phase::unknown);
        track.classes[place] = phase;
        track.sum = 0;
        track.count = 0;
    }
    touched_.clear();
    open_frames_ = 0;
    rows_.push_back(row);
}

void PhaseHistory::merge(const PhaseHistory& later) {
    close_window();
    PhaseHistory closed = later;
    closed.close_window();
    frames_ += closed.frames_;
    rows_.insert(rows_.end(), closed.rows_.begin(), closed.rows_.end());
    if (!closed.window_.length) window_ = closed.window_;
    for (const auto& [id, from] : closed.index_) {
        const Track& source = closed.tracks_[from];
        const auto [at, is_new] = index_.try_emplace(id, tracks_.size());
        if (is_new) {
            tracks_.push_back(source);
            continue;
        }
        Track& track = tracks_[at->second];
        if (track.classes.empty()) track.first_window = source.first_window;
        for (std::size_t w = 0; w < source.classes.size(); ++w) {
            const std::int64_t window = source.first_window + static_cast<std::int64_t>(w);
            if (window < track.first_window) continue;
            const auto place = static_cast<std::size_t>(window - track.first_window);
            if (track.classes.size() <= place) track.classes.resize(place + 1, Phase::unknown);
            if (track.classes[place] == Phase::unknown) track.classes[place] = source.classes[w];
        }
    }
}

std::span<const Phase> PhaseHistory::classes(std::int64_t id, std::int64_t& first_window) const {
    const auto at = index_.find(id);
    if (at == index_.end() || !window_.length) return {};
    first_window = tracks_[at->second].first_window;
    return tracks_[at->second].classes;
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
    Column solid{"solid_fraction", "-", "Solid fraction", {}};
    Column liquid{"liquid_fraction", "-", "Liquid fraction", {}};
    MeanSeries solid_mean;
    MeanSeries liquid_mean;
    for (const Row& row : rows_) {
        if (row.all <= 0) continue;
        frame.values.push_back(static_cast<double>(row.frame));
        solid.values.push_back(row.solid / row.all);
        liquid.values.push_back(row.liquid / row.all);
        solid_mean.add(row.solid / row.all);
        liquid_mean.add(row.liquid / row.all);
    }
    if (solid_mean.value.empty()) {
        result.reason = frames_ == 0 ? "no frames" : "no particle has a defined |Q4|";
        return result;
    }
    curve.columns = {frame, solid, liquid};
    result.curves = {curve};
    const std::string one = rows_.size() == 1 ? "one window: no error from fluctuations" : "";
    const std::string why = window_.reason.empty() ? one : window_.reason;
    for (auto& [name, mean] :
         {std::pair{"solid_fraction", &solid_mean}, std::pair{"liquid_fraction", &liquid_mean}}) {
        Measurement m = mean->measurement(name, "-", std::nullopt, why);
        m.reason = why;
        result.measurements.push_back(m);
    }
    if (window_.length) {
        result.measurements.push_back({"averaging_time", "time unit", window_.length, std::nullopt,
                                       0, "chosen, not measured"});
    } else {
        result.measurements.push_back(missing("averaging_time", "time unit", window_.reason));
    }
    return result;
}

}  // namespace grainfield::analysis
