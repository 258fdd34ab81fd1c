#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "bench/tracking/timed_run.h"
#include "tracking/model/disc_profile.h"

namespace grainfield::bench {

/// A fit of known spheres: from the same start, without detection.
class FitRun : public TimedRun {
 public:
    using Fit = std::function<std::vector<Vec2>()>;
    FitRun(const std::string& option, const std::string& value, Fit fit)
        : TimedRun(option, value), fit_(std::move(fit)) {}

 protected:
    std::optional<tracking::Located> find() override;

 private:
    Fit fit_;
};

/// All positions 0.03 D RMS per axis off.
std::vector<Vec2> displaced(const std::vector<Vec2>& positions, double diameter);

/// Ways of fitting a frame: the plain reference first (product of transmissions, double, all pixels
/// that a disc reaches), then each image model, single precision, narrower rings and fewer sweeps,
/// and the tracker's own joint fit with the product and as a blurred union. Arguments outlive the
/// runs.
std::vector<std::unique_ptr<TimedRun>> fit_runs(const Image& darkness,
                                                const tracking::DiscProfile& disc,
                                                const std::vector<Vec2>& start);

}  // namespace grainfield::bench
