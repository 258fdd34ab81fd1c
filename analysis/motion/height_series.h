#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analysis/pattern.h"
#include "core/results.h"
#include "core/support/checkpoint.h"
#include "core/trajectory.h"

namespace grainfield::analysis {

/// The observable "height": the layer's height against time, and the profile of heights.
///
/// Of each frame the mean of the known heights and the heights that 5 % and 95 % of them are below
/// (curve `height`: t, mean, low, high, n). Curve `height_profile`: density of heights over all
/// frames, in bins of 0.02 a from −5 a to 50 a.
///
/// The vertical motion is fitted to the mean height h(t_i) of the frames by least squares,
///
///   h(t) = h₀ + A sin(2π (f t + φ)),     φ in [0, 1): the phase of the layer at t = 0.
///
/// f is the frequency of the vibration where the trajectory knows it. Else it is searched between
/// one period in the series and half the frame rate, in steps of a quarter of the resolution, on
/// the first 2,048 frames; faster motion is seen folded back. Errors: A has s √(2/T) and φ has
/// s √(2/T)/(2π A), s² the mean square that is left, of frames taken as independent.
///
/// No motion, and a reason: fewer than eight frames with heights; frames at one or two phases of
/// the vibration (stroboscopic); A below five of its errors. Heights of synthesis are those above
/// the moving low plate, those of a simulation above the resting one: amplitudes differ by the
/// plate's.
///
/// Memory: 40 B a frame, and one profile.
class HeightSeries {
 public:
    struct Sample {
        double time = 0;
        double mean = 0, low = 0, high = 0;  ///< [a]
        std::int64_t known = 0;
        std::vector<double> z;  ///< the known heights, ascending [a]
    };

    explicit HeightSeries(const TrajectoryInfo& info);

    /// Thread-safe.
    static Sample measure(const Pattern& pattern);
    void add(const Sample& sample);
    void merge(const HeightSeries& later);
    ObservableResult result() const;

    /// What was gathered so far, under names that begin with `prefix`; `restore` takes it into one
    /// of the same trajectory. Throws InputError if it does not fit.
    void save(Checkpoint& checkpoint, const std::string& prefix) const;
    void restore(const Checkpoint& checkpoint, const std::string& prefix);

 private:
    struct Motion {
        double height = 0, amplitude = 0, phase = 0, rest = 0;  // rest: s²
    };
    std::optional<Motion> motion(double frequency, std::size_t frames) const;
    double searched_frequency() const;
    void add_motion(ObservableResult& result) const;

    std::optional<double> frequency_;  // of the vibration
    std::vector<double> time_, mean_, low_, high_;
    std::vector<std::int64_t> known_;
    std::vector<std::int64_t> profile_;
};

}  // namespace grainfield::analysis
