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
constexpr std::size_t least_frames = 12;
constexpr std::size_t searched_frames = 2048;
constexpr double least_periods = 2;
constexpr double most_chance = 1e-6;     // that noise alone looks so periodic
constexpr double least_distinct = 0.02;  // eigenvalue of the terms, per frame
constexpr int most_rounds = 30;

// Of four or five unknowns.
using Unknowns = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 5, 1>;
using UnknownsSquared = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 5, 5>;

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
    for (const double z : sample.z) {
        sample.mean += z / static_cast<double>(sample.known);
        sample.square += z * z / static_cast<double>(sample.known);
    }
    sample.low = quantile(sample.z, 0.05);
    sample.high = quantile(sample.z, 0.95);
    return sample;
}

void HeightSeries::add(const Sample& sample) {
    if (sample.known == 0) return;
    time_.push_back(sample.time);
    mean_.push_back(sample.mean);
    square_.push_back(sample.square);
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
    append(square_, later.square_);
    append(low_, later.low_);
    append(high_, later.high_);
    append(known_, later.known_);
    for (std::size_t b = 0; b < profile_.size(); ++b) profile_[b] += later.profile_[b];
}

void HeightSeries::save(Checkpoint& checkpoint, const std::string& prefix) const {
    checkpoint.reals[prefix + "time"] = time_;
    checkpoint.reals[prefix + "mean"] = mean_;
    checkpoint.reals[prefix + "square"] = square_;
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
    take(checkpoint.reals, "square", square_);
    take(checkpoint.reals, "low", low_);
    take(checkpoint.reals, "high", high_);
    take(checkpoint.integers, "known", known_);
    take(checkpoint.integers, "profile", profile_);
    const std::size_t frames = time_.size();
    const auto is_finite_number = [](double value) { return std::isfinite(value); };
    const bool are_numbers = std::ranges::all_of(time_, is_finite_number) &&
                             std::ranges::all_of(mean_, is_finite_number) &&
                             std::ranges::all_of(square_, is_finite_number);
    const auto is_bad = [](std::int64_t count) { return count < 0 || count > 1'000'000'000'000; };
    if (mean_.size() != frames || square_.size() != frames || low_.size() != frames ||
        high_.size() != frames || known_.size() != frames || profile_.size() != bins ||
        !are_numbers || std::ranges::any_of(profile_, is_bad) ||
        std::ranges::any_of(known_, is_bad)) {
        throw InputError(ErrorText{"stored heights do not fit", "columns of different lengths", "",
                                   "measure the part again"});
    }
}

struct HeightSeries::Motion {
    double frequency = 0, frequency_error = 0;
    double amplitude = 0, amplitude_error = 0;
    double phase = 0, phase_error = 0;    // at t = 0
    double height = 0, height_error = 0;  // h₀
    double left = 0;                      // sum of squares
    double chance = 1;                    // that noise is as periodic at one frequency
};

// Nothing where the times leave the terms indistinct.
std::optional<HeightSeries::Motion> HeightSeries::fit(double frequency, bool is_free,
                                                      std::size_t frames) const {
    const double middle = 0.5 * (time_.front() + time_[frames - 1]);
    const double half = 0.5 * (time_[frames - 1] - time_.front());
    const auto n = static_cast<double>(frames);
    const double first = mean_.front();           // so that nothing cancels
    Eigen::Vector4d c = Eigen::Vector4d::Zero();  // 1, drift, sine, cosine about the middle
    double left = 0, without = 0;
    UnknownsSquared covariance;
    for (int round = 0; round < (is_free ? most_rounds : 1); ++round) {
        // The last column is that of the frequency, in units of 1/(2π half).
        const Eigen::Index columns = is_free && round > 0 ? 5 : 4;
        UnknownsSquared normal = UnknownsSquared::Zero(columns, columns);
        Unknowns right = Unknowns::Zero(columns);
        double squares = 0;
        for (std::size_t i = 0; i < frames; ++i) {
            const double t = time_[i] - middle;
            const double angle = 2 * std::numbers::pi * std::fmod(frequency * t, 1.0);
            Unknowns terms(columns);
            terms.head<4>() << 1, t / half, std::sin(angle), std::cos(angle);
            if (columns == 5) terms[4] = t / half * (c[2] * terms[3] - c[3] * terms[2]);
            const double height = mean_[i] - first;
            normal += terms * terms.transpose();
            right += height * terms;
            squares += height * height;
        }
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> solver(normal.topLeftCorner<4, 4>());
        if (!(solver.eigenvalues()[0] > least_distinct * n)) return std::nullopt;
        const Unknowns found = normal.ldlt().solve(right);
        c = found.head<4>();
        left = std::max(0.0, squares - found.dot(right));
        const Eigen::Vector2d plain = normal.topLeftCorner<2, 2>().ldlt().solve(right.head<2>());
        without = std::max(0.0, squares - plain.dot(right.head<2>()));
        covariance = normal.inverse() * left / (n - static_cast<double>(columns));
        if (columns < 5) continue;
        const double step = found[4] / (2 * std::numbers::pi * half);
        frequency += std::clamp(step, -0.1 / half, 0.1 / half);
        if (std::abs(step) < 1e-9 / half) break;
    }
    Motion motion;
    motion.frequency = frequency;
    motion.left = left;
    motion.height = first + c[0];
    motion.height_error = std::sqrt(covariance(0, 0));
    motion.amplitude = std::hypot(c[2], c[3]);
    if (!(motion.amplitude > 0)) return motion;
    const double turns = std::atan2(c[3], c[2]) / (2 * std::numbers::pi) - frequency * middle;
    motion.phase = turns - std::floor(turns);
    const Eigen::Index columns = covariance.rows();
    Unknowns amplitude = Unknowns::Zero(columns);
    Unknowns phase = Unknowns::Zero(columns);
    amplitude.segment<2>(2) << c[2], c[3];
    amplitude /= motion.amplitude;
    phase.segment<2>(2) << -c[3], c[2];
    phase /= 2 * std::numbers::pi * motion.amplitude * motion.amplitude;
    if (columns == 5) {
        const double unit = 1 / (2 * std::numbers::pi * half);
        phase[4] = -middle * unit;
        motion.frequency_error = unit * std::sqrt(covariance(4, 4));
    }
    motion.amplitude_error = std::sqrt(amplitude.dot(covariance * amplitude));
    motion.phase_error = std::sqrt(phase.dot(covariance * phase));
    // Of the F distribution with 2 and ν degrees of freedom: P(F > x) = (1 + 2x/ν)^(−ν/2).
    motion.chance = std::pow(std::max(left, 1e-300) / std::max(without, 1e-300), 0.5 * (n - 4));
    return motion;
}

std::optional<HeightSeries::Motion> HeightSeries::searched(std::int64_t& tried) const {
    const std::size_t frames = std::min(time_.size(), searched_frames);
    const double length = time_[frames - 1] - time_.front();
    const double highest_frequency = 0.5 * static_cast<double>(frames - 1) / length;
    const auto steps = static_cast<std::int64_t>(4 * (highest_frequency * length - least_periods));
    std::optional<Motion> best;
    for (std::int64_t step = 0; step < steps; ++step) {
        const double f = (least_periods + 0.25 * static_cast<double>(step)) / length;
        const auto found = fit(f, false, frames);
        if (found && (!best || found->left < best->left)) best = found;
    }
    tried = std::max<std::int64_t>(1, steps);
    if (best) best = fit(best->frequency, true, frames);
    if (best && frames < time_.size()) best = fit(best->frequency, true, time_.size());
    return best;
}

void HeightSeries::add_motion(ObservableResult& result) const {
    const auto none = [&](const std::string& reason) {
        result.measurements.push_back(missing("height_amplitude", "a", reason));
    };
    const std::size_t frames = time_.size();
    if (frames < least_frames) {
        none(fmt::format("heights in {} of the {} frames that are needed", frames, least_frames));
        return;
    }
    if (std::ranges::adjacent_find(time_, std::ranges::greater_equal{}) != time_.end()) {
        none("times do not grow");
        return;
    }
    std::int64_t tried = 1;
    const auto found = frequency_ ? fit(*frequency_, false, frames) : searched(tried);
    if (!found) {
        none("frames are at one or two phases of the vibration");
        return;
    }
    const double chance = found->chance * static_cast<double>(tried);
    if (!(found->amplitude > 0) || !(chance < most_chance)) {
        none(fmt::format("{:.2g} ± {:.2g} a: noise alone is as periodic", found->amplitude,
                         found->amplitude_error));
        return;
    }
    const auto samples = static_cast<double>(frames);
    const auto add = [&](const char* name, const char* unit, double value, double error) {
        const bool is_exact = !(error > 0);
        result.measurements.push_back(
            is_exact ? measured(name, unit, value, std::nullopt, samples, "nothing is left over")
                     : measured(name, unit, value, error, samples));
    };
    for (Measurement& known : result.measurements) {
        if (known.name != "height_mean") continue;  // whose fluctuations were those of the motion
        known.value = found->height;
        if (found->height_error > 0) known.error = found->height_error;
        known.samples = samples;
    }
    add("height_amplitude", "a", found->amplitude, found->amplitude_error);
    add("height_phase", "-", found->phase, found->phase_error);
    if (frequency_) {
        result.measurements.push_back(measured("height_frequency", "1/time unit", *frequency_,
                                               std::nullopt, samples,
                                               "that of the vibration, as given"));
    } else {
        add("height_frequency", "1/time unit", found->frequency, found->frequency_error);
    }
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
    double in_profile = 0;
    for (const std::int64_t count : profile_) in_profile += static_cast<double>(count);
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
            static_cast<double>(profile_[static_cast<std::size_t>(b)]) / (in_profile * bin);
        profile.columns[0].values.push_back(z);
        profile.columns[1].values.push_back(density);
    }
    if (in_profile > 0) result.curves.push_back(std::move(profile));
    MeanSeries mean;
    for (const double height : mean_) mean.add(height);
    result.measurements.push_back(
        mean.measurement("height_mean", "a", std::nullopt, "one frame: no error"));
    double all = 0, sum = 0, squares = 0;
    for (std::size_t i = 0; i < time_.size(); ++i) {
        const auto n = static_cast<double>(known_[i]);
        all += n;
        sum += n * mean_[i];
        squares += n * square_[i];
    }
    const double average = sum / all;
    const double spread = std::sqrt(std::max(0.0, squares / all - average * average));
    result.measurements.push_back(measured("height_spread", "a", spread, std::nullopt, all,
                                           "of all spheres and frames: no error"));
    add_motion(result);
    return result;
}

}  // namespace grainfield::analysis
