#include "analysis/motion/height_series.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "analysis/statistics/blocks.h"
#include "core/errors.h"

namespace grainfield::analysis {
namespace {

constexpr double lowest = -5, highest = 50, bin = 0.02;  // of the profile [a]
constexpr std::size_t least_frames = 8;
constexpr std::size_t searched_frames = 2048;
constexpr double least_significance = 5;

// The value that a share of the sorted ones is below.
double quantile(const std::vector<double>& sorted, double share) {
    const double at = share * static_cast<double>(sorted.size() - 1);
    const auto below = static_cast<std::size_t>(at);
    const std::size_t above = std::min(below + 1, sorted.size() - 1);
    return std::lerp(sorted[below], sorted[above], at - static_cast<double>(below));
}

}  // namespace

HeightSeries::HeightSeries(const TrajectoryInfo& info)
    : frequency_(info.vibration_frequency),
      profile_(static_cast<std::size_t>(std::lround((highest - lowest) / bin)), 0) {}

HeightSeries::Sample HeightSeries::measure(const Pattern& pattern) {
    Sample sample;
    sample.time = pattern.time;
    std::ranges::copy_if(pattern.z, std::back_inserter(sample.z),
                         [](double z) { return !std::isnan(z); });
    sample.known = static_cast<std::int64_t>(sample.z.size());
    if (sample.z.empty()) return sample;
    std::ranges::sort(sample.z);
    for (const double z : sample.z) sample.mean += z / static_cast<double>(sample.known);
    sample.low = quantile(sample.z, 0.05);
    sample.high = quantile(sample.z, 0.95);
    return sample;
}

void HeightSeries::add(const Sample& sample) {
    if (sample.known == 0) return;
    time_.push_back(sample.time);
    mean_.push_back(sample.mean);
    low_.push_back(sample.low);
    high_.push_back(sample.high);
    known_.push_back(sample.known);
    for (const double z : sample.z) {
        if (z >= lowest && z < highest) {
            ++profile_[std::min(static_cast<std::size_t>((z - lowest) / bin), profile_.size() - 1)];
        }
    }
}

void HeightSeries::merge(const HeightSeries& later) {
    const auto append = [](auto& to, const auto& from) {
        to.insert(to.end(), from.begin(), from.end());
    };
    append(time_, later.time_);
    append(mean_, later.mean_);
    append(low_, later.low_);
    append(high_, later.high_);
    append(known_, later.known_);
    for (std::size_t b = 0; b < profile_.size(); ++b) profile_[b] += later.profile_[b];
}

void HeightSeries::save(Checkpoint& checkpoint, const std::string& prefix) const {
    checkpoint.reals[prefix + "time"] = time_;
    checkpoint.reals[prefix + "mean"] = mean_;
    checkpoint.reals[prefix + "low"] = low_;
    checkpoint.reals[prefix + "high"] = high_;
    checkpoint.integers[prefix + "known"] = known_;
    checkpoint.integers[prefix + "profile"] = profile_;
}

void HeightSeries::restore(const Checkpoint& checkpoint, const std::string& prefix) {
    const auto take = [&](const auto& stored, const char* name, auto& values) {
        const auto found = stored.find(prefix + name);
        if (found == stored.end()) {
            throw InputError(ErrorText{"stored heights do not fit",
                                       fmt::format("there is no '{}'", name), "",
                                       "measure the part again"});
        }
        values = found->second;
    };
    const std::size_t bins = profile_.size();
    take(checkpoint.reals, "time", time_);
    take(checkpoint.reals, "mean", mean_);
    take(checkpoint.reals, "low", low_);
    take(checkpoint.reals, "high", high_);
    take(checkpoint.integers, "known", known_);
    take(checkpoint.integers, "profile", profile_);
    const std::size_t frames = time_.size();
    const auto is_finite_number = [](double value) { return std::isfinite(value); };
    const bool are_numbers = std::ranges::all_of(time_, is_finite_number) &&
                             std::ranges::all_of(mean_, is_finite_number);
    const auto is_bad = [](std::int64_t count) { return count < 0 || count > 1'000'000'000'000; };
    if (mean_.size() != frames || low_.size() != frames || high_.size() != frames ||
        known_.size() != frames || profile_.size() != bins || !are_numbers ||
        std::ranges::any_of(profile_, is_bad) || std::ranges::any_of(known_, is_bad)) {
        throw InputError(ErrorText{"stored heights do not fit", "columns of different lengths", "",
                                   "measure the part again"});
    }
}

// Nothing where the times leave the three terms indistinct.
std::optional<HeightSeries::Motion> HeightSeries::motion(double frequency,
                                                         std::size_t frames) const {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d right = Eigen::Vector3d::Zero();
    const double first = mean_.front();  // so that nothing cancels
    double squares = 0;
    for (std::size_t i = 0; i < frames; ++i) {
        const double angle = 2 * std::numbers::pi * std::fmod(frequency * time_[i], 1.0);
        const Eigen::Vector3d terms(1, std::sin(angle), std::cos(angle));
        normal += terms * terms.transpose();
        right += terms * (mean_[i] - first);
        squares += (mean_[i] - first) * (mean_[i] - first);
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(normal);
    if (!(solver.eigenvalues()[0] > 0.02 * static_cast<double>(frames))) return std::nullopt;
    const Eigen::Vector3d c = normal.ldlt().solve(right);
    const double turn = std::atan2(c[2], c[1]) / (2 * std::numbers::pi);
    return Motion{.height = first + c[0],
                  .amplitude = std::hypot(c[1], c[2]),
                  .phase = turn < 0 ? turn + 1 : turn,
                  .rest = std::max(0.0, squares - c.dot(right)) /
                          std::max(1.0, static_cast<double>(frames) - 3)};
}

double HeightSeries::searched_frequency() const {
    const std::size_t frames = std::min(time_.size(), searched_frames);
    const double length = time_[frames - 1] - time_.front();
    const double rate = static_cast<double>(frames - 1) / length;
    double best = 0, amplitude = 0;
    for (double f = 1 / length; f <= 0.5 * rate; f += 0.25 / length) {
        const auto fit = motion(f, frames);
        if (!fit || fit->amplitude <= amplitude) continue;
        amplitude = fit->amplitude;
        best = f;
    }
    return best;
}

void HeightSeries::add_motion(ObservableResult& result) const {
    const auto none = [&](const std::string& reason) {
        result.measurements.push_back(missing("height_amplitude", "a", reason));
    };
    const std::size_t frames = time_.size();
    if (frames < least_frames) {
        none(fmt::format("{} frames with heights, {} are needed", frames, least_frames));
        return;
    }
    const double frequency = frequency_ ? *frequency_ : searched_frequency();
    const auto fit = motion(frequency, frames);
    if (!fit || !(fit->amplitude > 0)) {
        none(frequency_ ? "frames are at one or two phases of the vibration"
                        : "the mean height does not change");
        return;
    }
    const double error = std::sqrt(2 * fit->rest / static_cast<double>(frames));
    if (!(fit->amplitude > least_significance * error)) {
        none(fmt::format("{:.2g} ± {:.2g} a: less than {} errors", fit->amplitude, error,
                         least_significance));
        return;
    }
    const auto samples = static_cast<double>(frames);
    const double phase_error = error / (2 * std::numbers::pi * fit->amplitude);
    result.measurements.push_back(
        measured("height_amplitude", "a", fit->amplitude, error, samples));
    result.measurements.push_back(measured("height_phase", "-", fit->phase, phase_error, samples));
    result.measurements.push_back(
        measured("height_frequency", "1/time unit", frequency, std::nullopt, samples,
                 frequency_ ? "that of the vibration, as given" : "searched in steps: no error"));
}

ObservableResult HeightSeries::result() const {
    ObservableResult result;
    result.name = "height";
    if (time_.empty()) {
        result.reason = "heights are not known";
        return result;
    }
    std::vector<double> known(known_.begin(), known_.end());
    result.curves.push_back({"height",
                             "Height of the layer",
                             {{"t", "time unit", "Time", time_},
                              {"mean", "a", "Mean height", mean_},
                              {"low", "a", "Height that 5 % are below", low_},
                              {"high", "a", "Height that 95 % are below", high_},
                              {"n", "-", "Known heights", std::move(known)}},
                             {}});
    double all = 0, sum = 0, squares = 0;
    for (const std::int64_t count : profile_) all += static_cast<double>(count);
    Curve profile{"height_profile",
                  "Profile of heights",
                  {{"z", "a", "Height of the centre", {}}, {"density", "1/a", "Density", {}}},
                  {}};
    const auto is_filled = [](std::int64_t count) { return count > 0; };
    const auto from = std::ranges::find_if(profile_, is_filled) - profile_.begin();
    const auto end = profile_.rend() - std::find_if(profile_.rbegin(), profile_.rend(), is_filled);
    for (auto b = from; b < end; ++b) {
        const double z = lowest + (static_cast<double>(b) + 0.5) * bin;
        const double density =
            static_cast<double>(profile_[static_cast<std::size_t>(b)]) / (all * bin);
        profile.columns[0].values.push_back(z);
        profile.columns[1].values.push_back(density);
        sum += z * density * bin;
        squares += z * z * density * bin;
    }
    if (all > 0) result.curves.push_back(std::move(profile));
    MeanSeries mean;
    for (const double height : mean_) mean.add(height);
    result.measurements.push_back(
        mean.measurement("height_mean", "a", std::nullopt, "one frame: no error"));
    if (all > 0) {
        const double spread = std::sqrt(std::max(0.0, squares - sum * sum));
        result.measurements.push_back(
            measured("height_spread", "a", spread, std::nullopt, all, "of the profile: no error"));
    }
    add_motion(result);
    return result;
}

}  // namespace grainfield::analysis
