#include "bench/tracking/tracker_run.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string_view>

#include "core/run_plan.h"

namespace grainfield::bench {

using namespace tracking;

TrackerRun::TrackerRun(const KnownFrame& frame, const std::string& option, const std::string& value,
                       const Calibration* usual)
    : TimedRun(option, value), frame_(frame) {
    constexpr std::array<std::string_view, 4> of_calibration{"size", "meeting-edges", "profile",
                                                             "uniform-tolerance"};
    options_.threads = 1;
    apply(usual);
    if (usual == nullptr ||
        std::find(of_calibration.begin(), of_calibration.end(), option) != of_calibration.end()) {
        calibrate_anew();
    } else {
        calibration_ = *usual;
    }
    if (!calibration_) return;
    locator_.emplace(frame.counts.width(), frame.counts.height(), calibration_->model,
                     options_.threads);
    if (value == "warm") start_ = locate(frame.before).fitted;
}

std::optional<Located> TrackerRun::find() {
    if (!calibration_) return std::nullopt;
    return locate(frame_.counts);
}

void TrackerRun::calibrate_anew() {
    const double begin = processor_ms();
    RunPlan plan;
    calibration_ = calibrate(frame_.before, options_.calibration, options_.detection,
                             options_.refinement, options_.threads, plan);
    calibration_ms_ = processor_ms() - begin;
}

void TrackerRun::apply(const Calibration* usual) {
    const std::string& name = option();
    if (name == "default" || name == "start" || name == "control") return;
    if (name == "threads") {
        options_.threads = std::stoi(value());
    } else if (name == "size") {
        options_.calibration.diameter = usual->model.disc.diameter;
        options_.calibration.edge_width = usual->model.disc.edge_width;
    } else if (name == "cutoff") {
        options_.detection.cutoff = std::stod(value());
    } else if (name == "significance") {
        options_.detection.significance = std::stod(value());
    } else if (name == "max-passes") {
        options_.detection.max_passes = std::stoi(value());
    } else {
        for (const OptionTable& table : describe(options_)) {
            if (const Option* found = table.find(name)) {
                found->set_from_text(value());
                return;
            }
        }
        throw std::logic_error("no option " + name);
    }
}

Located TrackerRun::locate(const Image& counts) {
    return locator_->locate(calibration_->model.darkness(counts), options_.detection,
                            options_.refinement, start_);
}

}  // namespace grainfield::bench
