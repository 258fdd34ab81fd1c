#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "bench/tracking/known_frames.h"
#include "tracking/locate.h"
#include "tracking/score/detection_scores.h"

namespace grainfield::bench {

double processor_ms();

/// NaN of nothing.
double median(std::vector<double> values);

/// One way of finding the spheres of a frame, timed, several times in turn with others.
class TimedRun {
 public:
    TimedRun(std::string option, std::string value)
        : option_(std::move(option)), value_(std::move(value)) {}
    virtual ~TimedRun() = default;
    TimedRun(const TimedRun&) = delete;
    TimedRun& operator=(const TimedRun&) = delete;

    void take_turn();
    tracking::DetectionScores score(const tracking::TruthFrame& truth, double gate) const;
    const tracking::Located& found() const { return found_; }

    /// One row of CSV a class of spheres. Processor time and RMS difference of positions are also
    /// given relative to `usual`.
    void print(const std::string& group, const FrameSpec& spec, double noise,
               const tracking::DetectionScores& scores, const TimedRun& usual) const;
    static void print_head();

 protected:
    const std::string& option() const { return option_; }
    const std::string& value() const { return value_; }
    /// Nothing where the frame could not be calibrated.
    virtual std::optional<tracking::Located> find() = 0;
    virtual double calibration_ms() const { return 0; }

 private:
    std::array<double, 3> ratios(const TimedRun& usual) const;
    double difference(const TimedRun& usual, double gate) const;

    std::string option_, value_;
    tracking::Located found_;
    std::vector<double> cpu_, wall_;
};

}  // namespace grainfield::bench
