#include "tracking/tracker.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "core/interrupt.h"
#include "core/parallel.h"
#include "tracking/link/long_tracks.h"

namespace grainfield::tracking {
namespace {

/// How many frames are tried for calibration before giving up.
constexpr std::int64_t kCalibrationFrames = 10;

using Clock = std::chrono::steady_clock;
double milliseconds_since(Clock::time_point start) {
    return 1e3 * std::chrono::duration<double>(Clock::now() - start).count();
}

}  // namespace

std::vector<OptionTable> describe(TrackOptions& options) {
    OptionTable track("track");
    track.number("sphere-diameter", options.sphere_diameter, "px", {2, 2000},
                 "true diameter a of a sphere, the unit of the analysis; auto: the apparent one");
    return {describe(options.calibration), describe(options.detection),
            describe(options.refinement), describe(options.link), track};
}

Tracker::Tracker(FrameSource& source, const TrackOptions& options, RunPlan& plan)
    : source_(source), options_(options), plan_(plan), threads_(thread_count(options.threads)) {
    const std::int64_t count = source.count();
    const std::int64_t tries = std::min(count, kCalibrationFrames);
    for (std::int64_t i = 0; i < tries && !calibration_; ++i) {
        const std::int64_t index = i * count / tries;
        const Frame frame = source.read(index);
        if (frame.status != FrameStatus::ok) continue;
        RunPlan attempt;
        calibration_ = calibrate(frame.image, options.calibration, options.detection,
                                 options.refinement, threads_, attempt);
        if (calibration_) {
            calibration_frame_ = frame.index;
            for (const PlannedStage& s : attempt.stages()) {
                s.runs ? plan.run(s.stage, s.reason) : plan.skip(s.stage, s.reason, s.saved);
            }
        }
        for (const std::string& warning : attempt.warnings()) {
            plan.warn(fmt::format("{}, frame {}: {}", source.name(), frame.index, warning));
        }
    }
    if (!calibration_) {
        plan.warn(
            fmt::format("{}: no frame to calibrate on among {} tried; no spheres are reported",
                        source.name(), tries));
        return;
    }
    locator_ = std::make_unique<Locator>(source.width(), source.height(), model().disc, threads_);
    plan.run("detect", "χ² map, then likelihood gain of the residual until nothing changes");
    plan.run("refine", "joint least squares on the product of transmissions");
    if (count < 2) {
        plan.skip("link", "one frame", "identities");
    } else {
        plan.run("link", "least squared steps, optimal where spheres compete");
    }
}

TrajectoryInfo Tracker::info() const {
    TrajectoryInfo info;
    info.origin = Origin::video;
    info.length_unit = LengthUnit::pixel;
    info.frame_rate = source_.frame_rate();
    info.time_unit = info.frame_rate ? TimeUnit::second : TimeUnit::frame;
    info.diameter = options_.sphere_diameter.value_or(calibration_ ? model().disc.diameter : 1.0);
    info.source = source_.name();
    return info;
}

Snapshot Tracker::track(const Frame& frame, std::int64_t position, Linker& linker,
                        TrackSummary& summary) {
    Snapshot snapshot;
    snapshot.frame = frame.index;
    snapshot.time = frame.time;
    snapshot.box.origin = {-0.5, -0.5};
    snapshot.box.length = {static_cast<double>(frame.image.width()),
                           static_cast<double>(frame.image.height())};
    if (!calibration_) return snapshot;
    if (const std::string reason = blank_reason(frame.image); !reason.empty()) {
        plan_.warn(fmt::format("{}, frame {}: {}", source_.name(), frame.index, reason));
        return snapshot;
    }

    auto start = Clock::now();
    const Image darkness = model().darkness(frame.image);
    summary.ms_per_frame.detect += milliseconds_since(start);
    // The calibration has been there already.
    const bool calibrated_here = frame.index == calibration_frame_;
    Located found =
        locator_->locate(darkness, options_.detection, options_.refinement,
                         calibrated_here ? calibration_->positions : std::vector<Vec2>());
    summary.ms_per_frame.detect += 1e3 * found.detect_seconds;
    summary.ms_per_frame.refine += 1e3 * found.refine_seconds;
    summary.residual_rms += found.residual_rms;
    if (!found.settled_detection) {
        plan_.warn("some frames still gained or lost spheres after --max-passes");
    }
    if (static_cast<double>(found.unsettled) > 1e-3 * static_cast<double>(found.position.size())) {
        plan_.warn("in some frames more than 0.1 % of the spheres still moved after --max-sweeps");
    }
    if (found.position.empty()) {
        plan_.warn(fmt::format("{}, frame {}: no spheres found", source_.name(), frame.index));
    }
    snapshot.position = std::move(found.position);
    snapshot.quality = std::move(found.residual);
    snapshot.position_error = std::move(found.error);
    for (Vec2& e : snapshot.position_error) e *= found.noise;

    start = Clock::now();
    snapshot.id = linker.link(position, snapshot.position, snapshot.position_error);
    summary.ms_per_frame.link += milliseconds_since(start);
    return snapshot;
}

TrackSummary Tracker::run(SnapshotSink& sink, Progress& progress,
                          const std::function<void(const Frame&, const Snapshot&)>& each_frame) {
    TrackSummary summary;
    const double diameter = calibration_ ? model().disc.diameter : 1.0;
    Linker linker(options_.link, diameter);
    LongTracks long_tracks(sink, options_.link.minimum_length, options_.link.memory);
    double particles = 0;
    for (std::int64_t i = 0; i < source_.count() && caught_signal() == 0; ++i) {
        auto start = Clock::now();
        const Frame frame = source_.read(i);
        summary.ms_per_frame.read += milliseconds_since(start);
        progress.advance();
        if (frame.status != FrameStatus::ok) {
            ++(frame.status == FrameStatus::corrupt ? summary.frames_corrupt
                                                    : summary.frames_missing);
            plan_.warn(fmt::format("{}, frame {}: {}", source_.name(), frame.index, frame.message));
            continue;
        }
        const Snapshot snapshot = track(frame, i, linker, summary);
        particles += static_cast<double>(snapshot.size());
        ++summary.frames;
        start = Clock::now();
        long_tracks.write(snapshot);
        summary.ms_per_frame.write += milliseconds_since(start);
        if (each_frame) each_frame(frame, snapshot);
    }
    long_tracks.finish();
    progress.finish();
    const double n = std::max<double>(1, static_cast<double>(summary.frames));
    summary.particles_mean = particles / n;
    summary.residual_rms /= n;
    for (double* t :
         {&summary.ms_per_frame.read, &summary.ms_per_frame.detect, &summary.ms_per_frame.refine,
          &summary.ms_per_frame.link, &summary.ms_per_frame.write}) {
        *t /= n;
    }
    const LinkSummary& links = linker.summary();
    if (links.consecutive > 0) {
        summary.step_rms = std::sqrt(links.squared_steps / static_cast<double>(links.consecutive));
    }
    for (const std::string& warning : linker.warnings(diameter)) plan_.warn(warning);
    return summary;
}

}  // namespace grainfield::tracking
