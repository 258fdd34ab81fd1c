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
/// The vertical motion is fitted to the mean height h(t_i) of the T frames by least squares,
///
///   h(t) = h₀ + d (t − t_m) + A sin(2π (f t + φ)),     φ in [0, 1): the phase at t = 0,
///
/// t_m the middle of the series; d takes up a slow drift. f is the frequency of the vibration where
/// the trajectory knows it. Else it is searched between two periods in the series and half the
/// frame rate: where the residual is least, in steps of a quarter of the resolution over the first
/// 2,048 frames, then as one more unknown of the fit (Gauss–Newton) over all. Faster motion is seen
/// folded back. Errors are those of the fit, s² (JᵀJ)⁻¹ with s² the mean square that is left,
/// propagated to A and φ. They take frames as independent.
///
/// The mean height is h₀ then, with its error; else that
/// of the frames, whose fluctuations hold the motion.
///
/// No motion, and a reason: fewer than twelve frames with heights; times that do not grow; frames
/// at one or two phases of the vibration (stroboscopic); noise that would look as periodic once in
/// 10⁶ series or more often, by the F test of the two terms times the number of frequencies tried.
/// Heights of synthesis are those above the plates where they are, those of a simulation above the
/// resting low plate: amplitudes differ by that of the plates.
///
/// Memory: 48 B a frame, and one profile.
class HeightSeries {
 public:
    struct Sample {
        double time = 0;
        double mean = 0, low = 0, high = 0;  ///< [a]
        double square = 0;                   ///< mean of z² [a²]
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
    struct Motion;
    std::optional<Motion> fit(double frequency, bool is_free, std::size_t frames) const;
    std::optional<Motion> searched(std::int64_t& tried) const;
    void add_motion(ObservableResult& result) const;

    std::optional<double> frequency_;  // of the vibration
    std::vector<double> time_, mean_, square_, low_, high_;
    std::vector<std::int64_t> known_;
    std::vector<std::int64_t> profile_;
};

}  // namespace grainfield::analysis
