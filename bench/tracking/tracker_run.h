#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/tracking/timed_run.h"
#include "tracking/tracker.h"

namespace grainfield::bench {

/// The tracker with one option away from its defaults. Besides those of `track`: "start" (cold,
/// warm), "threads", "size" (given: D and w of the default calibration are told), "control" (the
/// defaults once more: how much times scatter that should be the same), and what is no option
/// because it improves neither time nor error ("cutoff", "significance", "max-passes";
/// docs/decisions.md).
class TrackerRun : public TimedRun {
 public:
    /// `usual`: the calibration with default options, where there is one; calibrates anew only if
    /// the option is one of calibration.
    TrackerRun(const KnownFrame& frame, const std::string& option, const std::string& value,
               const tracking::Calibration* usual = nullptr);

    const std::optional<tracking::Calibration>& calibration() const { return calibration_; }

 protected:
    std::optional<tracking::Located> find() override;
    double calibration_ms() const override { return calibration_ms_; }

 private:
    void calibrate_anew();
    void apply(const tracking::Calibration* usual);
    tracking::Located locate(const Image& counts);

    const KnownFrame& frame_;
    tracking::TrackOptions options_;
    double calibration_ms_ = 0;
    std::optional<tracking::Calibration> calibration_;
    std::optional<tracking::Locator> locator_;
    std::vector<Vec2> start_;
};

}  // namespace grainfield::bench
