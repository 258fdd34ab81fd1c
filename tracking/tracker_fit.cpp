// How Tracker fits the frames that it has read.
#include <algorithm>
#include <cmath>

#include "core/support/parallel.h"
#include "core/support/team.h"
#include "tracking/run_clock.h"
#include "tracking/synthesis/corrected_positions.h"
#include "tracking/tracker.h"
#include "tracking/warm_start.h"

namespace grainfield::tracking {
namespace {

/// A frame whose light was misjudged by more is fitted again [contrast].
constexpr double kLightAccuracy = 0.02;

}  // namespace

void Tracker::fit(std::vector<Job>& jobs) {
    if (!is_calibrated()) return;
    for (Job& job : jobs) {
        if (job.frame.status == FrameStatus::ok) {
            job.blank = blank_reason(job.frame.image, options_.visible);
        }
    }
    const auto repeats = [&](const Job& job, std::int64_t position, const Image& counts) {
        return job.is_usable() && position == job.position - 1 && counts == job.frame.image;
    };
    for (std::size_t k = 0; k < jobs.size(); ++k) {
        jobs[k].is_repeated =
            k == 0 ? repeats(jobs[k], previous_.position, previous_.counts)
                   : jobs[k - 1].is_usable() &&
                         repeats(jobs[k], jobs[k - 1].position, jobs[k - 1].frame.image);
    }
    std::vector<std::size_t> fitted;
    for (std::size_t k = 0; k < jobs.size(); ++k) {
        if (jobs[k].is_usable() && !jobs[k].is_repeated) fitted.push_back(k);
    }
    parallel_for(static_cast<std::int64_t>(fitted.size()), threads_, [&](std::int64_t i) {
        const auto lane = static_cast<std::size_t>(i);
        const int own = std::max(1, threads_ / static_cast<int>(fitted.size()));
        lanes_[lane].locator.set_threads(own);
        // One region for the whole frame, where a lane has threads of its own.
        on_team(own, [&](Team&) { fit(jobs[fitted[lane]], lanes_[lane]); });
    });
    if (!fitted.empty()) light_ = lanes_[fitted.size() - 1].illumination.state();
    if (!first_light_.has_reference) first_light_ = light_;
    for (std::size_t k = 0; k < jobs.size(); ++k) {
        if (jobs[k].is_repeated) jobs[k].found = k == 0 ? previous_.found : jobs[k - 1].found;
    }
}

/// One after the other, each on all threads: a frame starts from the one before it.
void Tracker::synthesise(std::vector<Job>& jobs) {
    const SynthesisedFrame* earlier = previous_.synthesised ? &*previous_.synthesised : nullptr;
    for (Job& job : jobs) {
        if (!job.is_usable()) continue;
        const auto begin = RunClock::now();
        job.synthesised = job.is_repeated
                              ? *earlier
                              : synthesis_->next(job.frame.image, job.discs, earlier, threads_);
        job.ms.synthesis += milliseconds_since(begin);
        earlier = &*job.synthesised;
        if (!first_optics_ && earlier->residual_rms > 0) {
            first_optics_ = synthesis_->optics_of(*earlier);
        }
    }
}

std::vector<Vec2> Tracker::start_for(const Job& job) const {
    // The calibration has been there already.
    if (job.frame.index == film_.frame) return film_.calibration->positions;
    const std::int64_t frames = job.position - previous_.position;
    if (frames > kSideBySide || static_cast<double>(frames) * previous_.step_rms >
                                    kWarmStep * fitted_model().disc.diameter) {
        return {};
    }
    return previous_.found.fitted;
}

void Tracker::fit(Job& job, Lane& lane) const {
    const Frame& frame = job.frame;
    auto begin = RunClock::now();
    if (!binning().is_none()) binning().bin(frame.image, lane.blocks);
    const Image& seen = binning().is_none() ? frame.image : lane.blocks;
    lane.illumination.continue_from(light_);
    Illumination light = lane.illumination.expected(seen);
    job.ms.detect += milliseconds_since(begin);
    std::vector<Vec2> places = start_for(job);
    // Before the first step is known it is taken to be a large one.
    double step = frame.index == film_.frame ? 0
                  : previous_.step_rms > 0
                      ? static_cast<double>(job.position - previous_.position) * previous_.step_rms
                      : kWarmStep * fitted_model().disc.diameter;
    DetectionOptions detection = fit_detection_;
    if (frame.index == film_.frame && !film_.calibration->is_complete) {
        // The calibration looked for most spheres only.
        detection.cores = CoreSearch::this_frame;
    }
    if (!places.empty() && frame.index != film_.frame) {
        detection.doubtful_are_false = previous_.found.doubtful_are_false;
    }
    for (int attempt = 0; attempt < 2; ++attempt) {
        begin = RunClock::now();
        job.found = lane.locator.locate(
            [&](int y, float* row) { fitted_model().darkness_row(seen, light, y, row); }, detection,
            fit_refinement_, places, step);
        if (attempt == 0) job.is_warm = job.found.warm && frame.index != film_.frame;
        // Drawing and what every frame needs besides count as refinement.
        job.ms.detect += 1e3 * job.found.detect_seconds;
        job.ms.refine += milliseconds_since(begin) - 1e3 * job.found.detect_seconds;
        begin = RunClock::now();
        const Illumination settled =
            lane.illumination.settled(seen, light, lane.locator.transmission());
        job.ms.detect += milliseconds_since(begin);
        const bool holds = std::abs(settled.offset - light.offset) < kLightAccuracy &&
                           std::abs(settled.span / light.span - 1) < kLightAccuracy;
        light = settled;
        if (holds) break;
        places = job.found.fitted;
        step = 0;
        detection.cores = CoreSearch::never;
        detection.doubtful_are_false = job.found.doubtful_are_false;
    }
    job.light = light;
    if (synthesis_) job.discs = job.found.fitted;
    if (!bias_) return;
    begin = RunClock::now();
    correct(job, seen, lane);
    job.ms.refine += milliseconds_since(begin);
}

void Tracker::correct(Job& job, const Image& counts, Lane& lane) const {
    for (Image* image : {&lane.darkness, &lane.residual}) {
        if (image->width() != counts.width() || image->height() != counts.height()) {
            *image = Image(counts.width(), counts.height());
        }
    }
    for (int y = 0; y < counts.height(); ++y) {
        fitted_model().darkness_row(counts, job.light, y, lane.darkness.row(y));
    }
    lane.locator.write_residual(lane.residual);
    const int own = std::max(1, threads_ / static_cast<int>(lanes_.size()));
    const double diameter = *options_.sphere_diameter / binning().factor;
    if (synthesis_) {
        job.discs = corrected_discs(*bias_, lane.darkness, lane.residual, diameter, job.found, own);
    } else {
        tracking::correct_bias(*bias_, lane.darkness, lane.residual, diameter, job.found, own);
    }
}

}  // namespace grainfield::tracking
