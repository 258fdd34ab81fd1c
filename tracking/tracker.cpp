#include "tracking/tracker.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/interrupt.h"
#include "core/parallel.h"

namespace grainfield::tracking {
namespace {

/// How many frames are tried for calibration before giving up.
constexpr std::int64_t kCalibrationFrames = 10;
/// Above this RMS step a cold search is the cheaper one [D].
constexpr double kWarmStep = 0.25;
/// A frame whose light was misjudged by more is fitted again [contrast].
constexpr double kLightAccuracy = 0.02;
constexpr double kNotableLight = 0.05;
constexpr double kPoorResidual = 0.12;
constexpr double kPoorInNoise = 2;
constexpr double kBadResidual = 0.25;

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
            describe(options.refinement),  describe(options.link),
            describe(options.layers),      track};
}

Tracker::Tracker(FrameSource& source, const TrackOptions& options, RunPlan& plan)
    : source_(source), options_(options), plan_(plan), threads_(thread_count(options.threads)) {
    if (options.layers.height && !options.sphere_diameter) {
        throw OptionError(ErrorText{"--height needs the true diameter of the spheres",
                                    "--sphere-diameter auto", "a [px], the unit of --height",
                                    "the dark disc is smaller than the sphere; give "
                                    "--sphere-diameter"});
    }
    const std::int64_t count = source.count();
    const std::int64_t tries = std::min(count, kCalibrationFrames);
    for (std::int64_t i = 0; i < tries && !calibration_; ++i) {
        const std::int64_t index = i * count / tries;
        const Frame frame = source.read(index);
        if (frame.status != FrameStatus::ok) continue;
        RunPlan attempt;
        calibration_ = calibrate(frame.image, options.calibration, options.detection,
                                 options.refinement, threads_, attempt, options.visible);
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
    locator_ = std::make_unique<Locator>(source.width(), source.height(), model().disc, threads_,
                                         model().meeting, model().correction);
    locator_->set_visible(options_.visible);
    illumination_ = std::make_unique<IlluminationFollower>(model(), options_.visible);
    plan.run("detect", "χ² map, then likelihood gain of the residual until nothing changes");
    plan.run("refine",
             fmt::format("joint least squares on the {}{}",
                         model().meeting == EdgeMeeting::product ? "product of transmissions"
                                                                 : "blurred union of discs",
                         model().correction.is_zero() ? "" : " of the learned profile"));
    if (count < 2) {
        plan.skip("link", "one frame", "identities");
    } else {
        plan.run("link", "least squared steps, optimal where spheres compete");
        plan.run("warm start",
                 fmt::format("frames begin with the spheres of the frame before while "
                             "these move less than {:.2g} D a frame",
                             kWarmStep));
    }
    if (options_.layers.height) {
        plan.run("layers", "overlaps in projection, up to turning each cluster of spheres over");
    } else {
        plan.skip("layers", "--height not given", "layer labels, rejection of impossible spheres");
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

std::vector<Vec2> Tracker::start_for(const Frame& frame, std::int64_t position) const {
    // The calibration has been there already.
    if (frame.index == calibration_frame_) return calibration_->positions;
    if (position != previous_.position + 1 ||
        previous_.step_rms > kWarmStep * model().disc.diameter) {
        return {};
    }
    return previous_.found.fitted;
}

void Tracker::locate(const Frame& frame, std::int64_t position, TrackSummary& summary) {
    if (position == previous_.position + 1 && frame.image == previous_.counts) {
        ++summary.repeated;
        previous_.position = position;
        return;
    }
    auto start = Clock::now();
    Illumination light = illumination_->expected(frame.image);
    summary.ms_per_frame.detect += milliseconds_since(start);
    std::vector<Vec2> places = start_for(frame, position);
    // Before the first step is known it is taken to be a large one.
    double step = frame.index == calibration_frame_ ? 0
                  : previous_.step_rms > 0          ? previous_.step_rms
                                                    : kWarmStep * model().disc.diameter;
    Located found;
    bool warm = false;
    for (int attempt = 0; attempt < 2; ++attempt) {
        found = locator_->locate(
            [&](int y, float* row) { model().darkness_row(frame.image, light, y, row); },
            options_.detection, options_.refinement, places, step);
        if (attempt == 0) warm = found.warm;
        summary.ms_per_frame.detect += 1e3 * found.detect_seconds;
        summary.ms_per_frame.refine += 1e3 * found.refine_seconds;
        start = Clock::now();
        const Illumination settled =
            illumination_->settled(frame.image, light, locator_->transmission());
        summary.ms_per_frame.detect += milliseconds_since(start);
        const bool holds = std::abs(settled.offset - light.offset) < kLightAccuracy &&
                           std::abs(settled.span / light.span - 1) < kLightAccuracy;
        light = settled;
        if (holds) break;
        places = found.fitted;
        step = 0;
    }
    summary.warm_frames += warm && frame.index != calibration_frame_;
    summary.dimmest = std::min(summary.dimmest, light.span);
    summary.brightest = std::max(summary.brightest, light.span);
    previous_ = {position, {}, std::move(found), 0};
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
    if (const std::string reason = blank_reason(frame.image, options_.visible); !reason.empty()) {
        plan_.warn(fmt::format("{}, frame {}: {}", source_.name(), frame.index, reason));
        return snapshot;
    }
    locate(frame, position, summary);
    const Located& found = previous_.found;
    judge(found, frame, summary);
    snapshot.position = found.position;
    snapshot.quality = found.residual;
    snapshot.position_error = found.error;
    for (std::size_t j = 0; j < found.error.size(); ++j) {
        // Where the image model is wrong, its misfit limits the position, not the camera's noise.
        snapshot.position_error[j] *= std::max(found.noise, found.residual[j]);
    }

    if (bilayer_) bilayer_->admit(snapshot, found.explained);
    const auto start = Clock::now();
    const LinkSummary before = linker.summary();
    snapshot.id = linker.link(position, snapshot.position, snapshot.position_error);
    const LinkSummary& after = linker.summary();
    if (const std::int64_t steps = after.consecutive - before.consecutive; steps > 0) {
        previous_.step_rms =
            std::sqrt((after.squared_steps - before.squared_steps) / static_cast<double>(steps));
    }
    if (bilayer_) {
        bilayer_->label(snapshot);
        summary.layers = bilayer_->summary();
    }
    summary.ms_per_frame.link += milliseconds_since(start);
    return snapshot;
}

void Tracker::judge(const Located& found, const Frame& frame, TrackSummary& summary) {
    summary.residual_rms += found.residual_rms;
    summary.unsettled += found.unsettled;
    summary.rejected += found.rejected;
    if (!found.settled_detection) {
        plan_.warn("some frames still gained or lost spheres when the search was ended");
    }
    if (static_cast<double>(found.unsettled) > 1e-3 * static_cast<double>(found.position.size())) {
        plan_.warn("in some frames more than 0.1 % of the spheres still moved after --max-sweeps");
    }
    if (found.position.empty()) {
        plan_.warn(fmt::format("{}, frame {}: no spheres found", source_.name(), frame.index));
    } else if (found.residual_rms >
               std::clamp(kPoorInNoise * found.noise, kPoorResidual, kBadResidual)) {
        ++summary.poor_frames;
        if (found.residual_rms > summary.worst_residual) {
            summary.worst_residual = found.residual_rms;
            summary.worst_frame = frame.index;
        }
    }
}

/// What a user should know of the frames as a whole.
void Tracker::summarise(const TrackSummary& summary) {
    if (summary.rejected > 0) {
        plan_.warn(
            fmt::format("{} positions left out in {} frames: they had not settled to within "
                        "their own error",
                        summary.rejected, summary.frames));
    }
    if (summary.poor_frames > 0) {
        plan_.warn(fmt::format(
            "the image model explains {} of {} frames badly, worst frame {}: RMS residual {:.2f} "
            "of the contrast (0.02 to 0.08 is usual); look at the overlay in the report, and try "
            "--polarity, --diameter or --edge-width",
            summary.poor_frames, summary.frames, summary.worst_frame, summary.worst_residual));
    }
    const Bilayer::Summary& layers = summary.layers;
    if (const std::int64_t n = layers.rejected_pairs + layers.rejected_triples; n > 0) {
        plan_.warn(fmt::format(
            "{} detections left out: no room for them between the plates ({} in pairs, {} in "
            "triples){}",
            n, layers.rejected_pairs, layers.rejected_triples,
            layers.is_exact ? "" : "; perhaps not the fewest possible"));
    }
    if (layers.contradictory > 0) {
        plan_.warn(fmt::format(
            "{} of {} positions have no layer because their overlaps contradict each other; is "
            "--height or --sphere-diameter too small, or a sphere false?",
            layers.contradictory, layers.spheres));
    }
    if (summary.repeated > 0) {
        plan_.warn(fmt::format("{} frames repeat the one before", summary.repeated));
    }
    if (summary.dimmest < 1 - kNotableLight || summary.brightest > 1 + kNotableLight) {
        plan_.warn(fmt::format(
            "the contrast varies between {:.2f} and {:.2f} of the first frame's; it was followed",
            summary.dimmest, summary.brightest));
    }
}

TrackSummary Tracker::run(SnapshotSink& sink, Progress& progress,
                          const std::function<void(const Frame&, const Snapshot&)>& each_frame,
                          const TrackResumption& resumption) {
    previous_ = {};
    bilayer_.reset();
    if (options_.layers.height) {
        if (!options_.layers.camera_distance) {
            plan_.warn(
                "layers.camera-distance is not given: the lens is taken as telecentric. One with "
                "perspective moves spheres of both layers against each other by R (L_z - a)/Z at R "
                "from the middle; then layers would be wrong and spheres rejected that are there");
        }
        bilayer_.emplace(SphereCell{.diameter = *options_.sphere_diameter,
                                    .height = *options_.layers.height,
                                    .camera_distance = options_.layers.camera_distance.value_or(0),
                                    .axis = {0.5 * static_cast<double>(source_.width() - 1),
                                             0.5 * static_cast<double>(source_.height() - 1)}});
    }
    const double diameter = calibration_ ? model().disc.diameter : 1.0;
    Run run{.linker = Linker(options_.link, diameter),
            .long_tracks = LongTracks(sink, options_.link.minimum_length, options_.link.memory),
            .summary = {}};
    Linker& linker = run.linker;
    LongTracks& long_tracks = run.long_tracks;
    TrackSummary& summary = run.summary;
    if (resumption.from != nullptr) {
        restore(run, *resumption.from);
        progress.resume_at(run.next);
    }
    while (run.next < source_.count() && caught_signal() == 0) {
        const std::int64_t i = run.next++;
        auto start = Clock::now();
        Frame frame = source_.read(i);
        if (caught_signal() != 0) {  // the source may have cut short what the frame is made from
            --run.next;
            break;
        }
        summary.ms_per_frame.read += milliseconds_since(start);
        progress.advance();
        if (frame.status != FrameStatus::ok) {
            ++(frame.status == FrameStatus::corrupt ? summary.frames_corrupt
                                                    : summary.frames_missing);
            plan_.warn(fmt::format("{}, frame {}: {}", source_.name(), frame.index, frame.message));
            continue;
        }
        const Snapshot snapshot = track(frame, i, linker, summary);
        run.particles += static_cast<double>(snapshot.size());
        ++summary.frames;
        start = Clock::now();
        long_tracks.write(snapshot);
        summary.ms_per_frame.write += milliseconds_since(start);
        if (each_frame) each_frame(frame, snapshot);
        if (previous_.position == i) previous_.counts = std::move(frame.image);
        if (resumption.save && run.next < source_.count() && resumption.is_due()) {
            resumption.save(checkpoint(run));
        }
    }
    if (resumption.save && run.next < source_.count()) resumption.save(checkpoint(run));
    long_tracks.finish();
    progress.finish();
    const double n = std::max<double>(1, static_cast<double>(summary.frames));
    summary.particles_mean = run.particles / n;
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
    summarise(summary);
    return summary;
}

}  // namespace grainfield::tracking
