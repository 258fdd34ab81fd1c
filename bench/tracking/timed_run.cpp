#include "bench/tracking/timed_run.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>

#include <fmt/format.h>

#include "tracking/score/match_positions.h"

namespace grainfield::bench {

using tracking::ClassScore;
using tracking::DetectionScores;

double processor_ms() {
    timespec t{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

double median(std::vector<double> values) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::sort(values.begin(), values.end());
    return values[values.size() / 2];
}

void TimedRun::take_turn() {
    const auto wall = std::chrono::steady_clock::now();
    const double begin = processor_ms();
    std::optional<tracking::Located> found = find();
    const double spent = processor_ms() - begin;
    if (!found) return;
    cpu_.push_back(spent);
    wall_.push_back(
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - wall).count());
    found_ = std::move(*found);
}

DetectionScores TimedRun::score(const tracking::TruthFrame& truth, double gate) const {
    DetectionScores scores({"all", "crystal"}, gate);
    std::vector<Vec2> errors = found_.error;
    for (std::size_t j = 0; j < errors.size(); ++j) {
        errors[j] *= std::max(found_.noise, found_.residual[j]);
    }
    scores.add(truth, found_.position, errors);
    return scores;
}

// Processor time over that of `usual` in the same turn: least, median, most.
std::array<double, 3> TimedRun::ratios(const TimedRun& usual) const {
    std::vector<double> ratio;
    for (std::size_t turn = 0; turn < cpu_.size(); ++turn) {
        ratio.push_back(cpu_[turn] / usual.cpu_[turn]);
    }
    if (ratio.empty()) return {median({}), median({}), median({})};
    const auto [least, most] = std::minmax_element(ratio.begin(), ratio.end());
    return {*least, median(ratio), *most};
}

// RMS per axis of the positions that both found [px].
double TimedRun::difference(const TimedRun& usual, double gate) const {
    const std::vector<Vec2>& mine = found_.position;
    const std::vector<Vec2>& theirs = usual.found_.position;
    if (mine.empty() || theirs.empty()) return median({});
    const std::vector<int> partner = tracking::match_positions(mine, theirs, gate);
    double squares = 0;
    double count = 0;
    for (std::size_t i = 0; i < theirs.size(); ++i) {
        if (partner[i] < 0) continue;
        squares += squared_norm(mine[static_cast<std::size_t>(partner[i])] - theirs[i]) / 2;
        ++count;
    }
    return std::sqrt(squares / count);
}

void TimedRun::print_head() {
    fmt::print(
        "group,camera,scene,diameter,noise,edge,path,noise_seen,option,value,class,spheres,cpu_ms,"
        "ratio_low,ratio,ratio_high,wall_ms,cpu_us_per_sphere,calibrate_ms,recall,missed,false,"
        "rmse_x,rmse_y,bound,over_bound,pull,difference\n");
}

void TimedRun::print(const std::string& group, const FrameSpec& spec, double noise,
                     const DetectionScores& scores, const TimedRun& usual) const {
    const double cpu = median(cpu_);
    const auto [least, middle, most] = ratios(usual);
    const auto spheres = static_cast<double>(found_.position.size());
    for (const ClassScore& s : scores.classes()) {
        if (s.name != "all" && spec.matter != Matter::patch) continue;
        fmt::print(
            "{},{},{},{:g},{:g},{:g},{:g},{:.4f},{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},"
            "{:.2f},{:.2f},{:.6f},{},{},{:.6f},{:.6f},{:.6f},{:.4f},{:.3f},{:.3g}\n",
            group, spec.camera == CameraModel::own ? "own" : "silhouette", spec.scene(),
            spec.diameter, spec.noise, spec.edge, spec.path, noise, option_, value_, s.name,
            found_.position.size(), cpu, least, middle, most, median(wall_), 1e3 * cpu / spheres,
            calibration_ms(), s.recall(), s.missed, s.spurious, s.rmse().x, s.rmse().y, s.bound(),
            s.bound_ratio(), s.pull_rms(), difference(usual, spec.diameter / 4));
    }
    std::fflush(stdout);
}

}  // namespace grainfield::bench
