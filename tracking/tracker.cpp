#include "tracking/tracker.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/parallel.h"
#include "core/support/team.h"
#include "tracking/point_grid.h"

namespace grainfield::tracking {
namespace {

/// Frames are fitted in twos; the second starts from spheres two frames old.
constexpr std::int64_t kSideBySide = 2;
/// Above this RMS step a cold search is the cheaper one [D].
constexpr double kWarmStep = 0.25;
/// A frame whose light was misjudged by more is fitted again [contrast].
constexpr double kLightAccuracy = 0.02;

using Clock = std::chrono::steady_clock;
double milliseconds_since(Clock::time_point start) {
    return 1e3 * std::chrono::duration<double>(Clock::now() - start).count();
}

/// Enough discs for their RMS step to within a few percent.
constexpr std::size_t kStepSample = 1000;

/// RMS distance of discs from the nearest of the frame before, the start of a warm search [px]. If
/// most have none within D/2, D. Identities play no part: they may be given later. O(discs).
double step_between(const std::vector<Vec2>& before, const std::vector<Vec2>& now,
                    double diameter) {
    if (before.empty() || now.empty()) return 0;
    const double range = 0.5 * diameter;
    const PointGrid grid(before, range);
    const std::size_t stride = (now.size() - 1) / kStepSample + 1;
    double squares = 0;
    std::size_t near = 0;
    std::size_t all = 0;
    for (std::size_t i = 0; i < now.size(); i += stride) {
        double nearest = range * range;
        grid.near(now[i], range, [&](std::uint32_t, Vec2 p) {
            nearest = std::min(nearest, squared_norm(p - now[i]));
        });
        ++all;
        if (nearest >= range * range) continue;
        squares += nearest;
        ++near;
    }
    return 2 * near < all ? diameter : std::sqrt(squares / static_cast<double>(near));
}

/// Throws OptionError where an option needs another one.
void require_diameter(const TrackOptions& options) {
    if (options.layers.height && !options.sphere_diameter) {
        throw OptionError(
            ErrorText{"the height of the cell needs the true diameter of the spheres",
                      "track.sphere-diameter is not known", "a [px], the unit of layers.height",
                      "the dark disc is smaller than the sphere; measure the sphere"});
    }
    if (options.synthesis && !options.sphere_diameter) {
        throw OptionError(
            ErrorText{"synthesis needs the true diameter of the spheres",
                      "track.sphere-diameter is not known", "a [px]",
                      "give track.sphere-diameter; the dark disc is smaller than the sphere"});
    }
    if (options.synthesis && options.camera) {
        throw OptionError({.problem = "synthesis cannot be corrected for lens and tilt",
                           .actual = "a camera is given",
                           .expected = "no camera: it renders spheres as a straight lens sees them",
                           .suggestion = "leave out the camera, or synthesis"});
    }
    if (options.synthesis && !options.visible.are_all()) {
        throw OptionError(ErrorText{"synthesis renders whole frames", "a mask hides part of them",
                                    "no mask", "choose a region without hidden pixels instead"});
    }
}

/// Leaves out the spheres beside the box; `evidence` has one entry each, too.
void keep_within(const Box& box, Snapshot& snapshot, std::vector<double>& evidence) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < snapshot.size(); ++i) {
        if (!box.contains(snapshot.position[i])) continue;
        snapshot.position[kept] = snapshot.position[i];
        snapshot.position_error[kept] = snapshot.position_error[i];
        snapshot.quality[kept] = snapshot.quality[i];
        evidence[kept] = evidence[i];
        ++kept;
    }
    snapshot.position.resize(kept);
    snapshot.position_error.resize(kept);
    snapshot.quality.resize(kept);
    evidence.resize(kept);
}

}  // namespace

std::vector<OptionTable> describe(TrackOptions& options) {
    OptionTable track("track");
    track.number("sphere-diameter", options.sphere_diameter, "px", {2, 2000},
                 "true diameter a of a sphere, the unit of the analysis; auto: the apparent one");
    track.flag("synthesis", options.synthesis,
               "positions and heights of mirror-like spheres by rendering the frame");
    track.integer("stretch", options.stretch, "frames", {2, 1e9},
                  "frames that start from one another; then the search begins afresh, so that "
                  "parts of a film give what the whole film gives");
    return {describe(options.calibration),
            describe(options.detection),
            describe(options.refinement),
            describe(options.link),
            describe(options.layers),
            describe(options.synthesis_options),
            track};
}

Tracker::Tracker(FrameSource& source, const TrackOptions& options, RunPlan& plan)
    : source_(source), options_(options), plan_(plan), threads_(thread_count(options.threads)) {
    require_diameter(options);
    box_.origin = {-0.5, -0.5};
    box_.length = {static_cast<double>(source.width()), static_cast<double>(source.height())};
    if (options.camera) box_ = options.camera->box(source.width(), source.height());
    // Mirrors before a panel are dark.
    PolarityChoice& polarity = options_.calibration.polarity;
    if (options.synthesis && !options.kept && polarity == PolarityChoice::automatic) {
        polarity = PolarityChoice::dark;
    }
    if (options_.kept) {
        if (const CalibrationOptions& given = options_.calibration; given != CalibrationOptions{}) {
            throw OptionError({.problem = "a kept calibration leaves nothing to estimate",
                               .actual = "options of the section calibrate are given as well",
                               .expected = "either of them",
                               .suggestion = "leave out the options, or calibrate again"});
        }
        film_ = use_kept(*options_.kept, source, options_.visible, threads_, plan);
    } else {
        film_ = calibrate_film(source, options_.calibration, options_.detection,
                               options_.refinement, options_.visible, threads_, plan);
        if (options_.keeps && is_calibrated()) {
            // Films that use it do not know where the spheres of this one were.
            film_.calibration->positions.clear();
            film_.frame = -1;
        }
    }
    if (!is_calibrated()) return;
    const std::int64_t count = source.count();
    const int lanes = static_cast<int>(std::min<std::int64_t>(kSideBySide, count));
    for (int lane = 0; lane < lanes; ++lane) {
        lanes_.push_back({Locator(source.width(), source.height(), model(), threads_),
                          IlluminationFollower(model(), options_.visible)});
        lanes_.back().locator.set_visible(options_.visible);
    }
    plan.run("detect", "χ² map, then likelihood gain of the residual until nothing changes");
    plan.run("refine", fmt::format("joint least squares on the {}{}", model().overlap->title(),
                                   model().correction.is_zero() ? "" : " of the learned profile"));
    if (count < 2) {
        plan.skip("link", "one frame", "identities");
    } else {
        if (options.part) {
            plan.skip("link", "a part of the film: 'grainfield link' joins parts", "identities");
        } else {
            plan.run("link", "least squared steps, optimal where spheres compete");
        }
        plan.run("warm start",
                 fmt::format("frames begin, two at a time, with the spheres of the frame before "
                             "them while these move less than {:.2g} D",
                             kWarmStep));
    }
    plan_camera(plan);
    plan_heights(plan);
}

void Tracker::plan_camera(RunPlan& plan) {
    if (!options_.camera) return;
    const double all = static_cast<double>(source_.width()) * source_.height();
    plan.run("camera",
             fmt::format("positions corrected for lens and tilt; box of {:.1f} x {:.1f} px{}, "
                         "{:.1f} % of the frame",
                         box_.length.x, box_.length.y,
                         options_.camera->camera().cell ? " between the walls" : "",
                         100 * box_.area() / all));
}

void Tracker::plan_heights(RunPlan& plan) {
    if (options_.synthesis) {
        SynthesisOptions& synthesis = options_.synthesis_options;
        synthesis.height = options_.layers.height.value_or(synthesis.height);
        synthesis_.emplace(model(), *options_.sphere_diameter,
                           options_.layers.camera_distance.value_or(0), synthesis);
        plan.run("synthesis",
                 fmt::format("mirror spheres rendered and fitted to each frame in x, y and z; "
                             "plates {:.4g} a apart, optics from the first frame",
                             synthesis.height));
        plan.run("layers", "the side of the middle of the cell on which synthesis has a sphere");
        return;
    }
    if (options_.layers.height) {
        plan.run("layers", "overlaps in projection, up to turning each cluster of spheres over");
    } else {
        plan.skip("layers", "the height of the cell is not known (layers.height)",
                  "layer labels, rejection of impossible spheres");
    }
}

TrajectoryInfo Tracker::info() const {
    TrajectoryInfo info;
    info.origin = Origin::video;
    info.length_unit = LengthUnit::pixel;
    info.frame_rate = source_.frame_rate();
    info.time_unit = info.frame_rate ? TimeUnit::second : TimeUnit::frame;
    info.diameter =
        options_.sphere_diameter.value_or(is_calibrated() ? model().disc.diameter : 1.0);
    info.diameter_origin =
        options_.sphere_diameter ? DiameterOrigin::given : DiameterOrigin::apparent;
    info.source = source_.name();
    return info;
}

/// The frames that are fitted next, side by side; alone until one has said what the light of the
/// others is compared with. A run that is taken up goes on where such a group begins.
std::vector<Tracker::Job> Tracker::read(Run& run) {
    const auto begin = Clock::now();
    const std::int64_t first = run.next;
    const std::int64_t in_stretch = first % options_.stretch;
    const bool is_alone = in_stretch == 0 || !light_.has_reference;
    const std::int64_t end = std::min(
        {span().end, first - in_stretch + options_.stretch, first + (is_alone ? 1 : kSideBySide)});
    std::vector<Job> jobs;
    for (; run.next < end; ++run.next) {
        Job& job = jobs.emplace_back();
        job.frame = source_.read(run.next);
        job.position = run.next;
        if (caught_signal() != 0) {  // the source may have cut short what the frame is made from
            run.next = first;
            return {};
        }
    }
    run.summary.ms_per_frame.read += milliseconds_since(begin);
    return jobs;
}

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
    if (synthesis_) synthesise(jobs);
}

/// One after the other, each on all threads: a frame starts from the one before it.
void Tracker::synthesise(std::vector<Job>& jobs) {
    const SynthesisedFrame* earlier = previous_.synthesised ? &*previous_.synthesised : nullptr;
    for (Job& job : jobs) {
        if (!job.is_usable()) continue;
        const auto begin = Clock::now();
        job.synthesised = job.is_repeated ? *earlier
                                          : synthesis_->next(job.frame.image, job.found.fitted,
                                                             earlier, threads_);
        job.ms.synthesis += milliseconds_since(begin);
        earlier = &*job.synthesised;
        if (!first_optics_ && earlier->residual_rms > 0) {
            first_optics_.emplace();
            first_optics_->optics = earlier->optics;
            first_optics_->residual_rms = earlier->residual_rms;
        }
    }
}

FrameSpan Tracker::span() const {
    return options_.part.value_or(FrameSpan{0, source_.count()});
}

FrameSpan Tracker::frames_to_fit() const {
    const FrameSpan wanted = span();
    return {wanted.begin - wanted.begin % options_.stretch, wanted.end};
}

/// The light, and the optics, that the first usable frame before the part leaves to all others.
void Tracker::find_first_light() {
    const std::int64_t end = frames_to_fit().begin;
    for (std::int64_t position = 0; position < end && !first_light_.has_reference; ++position) {
        std::vector<Job> jobs(1);
        jobs[0].frame = source_.read(position);
        jobs[0].position = position;
        if (caught_signal() != 0) return;
        fit(jobs);
    }
}

void Tracker::begin_stretch() {
    previous_ = {};
    previous_.synthesised = first_optics_;
    light_ = first_light_;
}

std::vector<Vec2> Tracker::start_for(const Job& job) const {
    // The calibration has been there already.
    if (job.frame.index == film_.frame) return film_.calibration->positions;
    const std::int64_t frames = job.position - previous_.position;
    if (frames > kSideBySide ||
        static_cast<double>(frames) * previous_.step_rms > kWarmStep * model().disc.diameter) {
        return {};
    }
    return previous_.found.fitted;
}

void Tracker::fit(Job& job, Lane& lane) const {
    const Frame& frame = job.frame;
    auto begin = Clock::now();
    lane.illumination.continue_from(light_);
    Illumination light = lane.illumination.expected(frame.image);
    job.ms.detect += milliseconds_since(begin);
    std::vector<Vec2> places = start_for(job);
    // Before the first step is known it is taken to be a large one.
    double step = frame.index == film_.frame ? 0
                  : previous_.step_rms > 0
                      ? static_cast<double>(job.position - previous_.position) * previous_.step_rms
                      : kWarmStep * model().disc.diameter;
    DetectionOptions detection = options_.detection;
    // The calibration looked for most spheres only.
    if (frame.index == film_.frame) detection.cores = CoreSearch::this_frame;
    for (int attempt = 0; attempt < 2; ++attempt) {
        begin = Clock::now();
        job.found = lane.locator.locate(
            [&](int y, float* row) { model().darkness_row(frame.image, light, y, row); }, detection,
            options_.refinement, places, step);
        if (attempt == 0) job.is_warm = job.found.warm && frame.index != film_.frame;
        // Drawing and what every frame needs besides count as refinement.
        job.ms.detect += 1e3 * job.found.detect_seconds;
        job.ms.refine += milliseconds_since(begin) - 1e3 * job.found.detect_seconds;
        begin = Clock::now();
        const Illumination settled =
            lane.illumination.settled(frame.image, light, lane.locator.transmission());
        job.ms.detect += milliseconds_since(begin);
        const bool holds = std::abs(settled.offset - light.offset) < kLightAccuracy &&
                           std::abs(settled.span / light.span - 1) < kLightAccuracy;
        light = settled;
        if (holds) break;
        places = job.found.fitted;
        step = 0;
        detection.cores = CoreSearch::never;
    }
    job.light = light;
}

Snapshot Tracker::snapshot_of(const Job& job, Run& run) {
    Snapshot snapshot;
    snapshot.frame = job.frame.index;
    snapshot.time = job.frame.time;
    snapshot.box = box_;
    if (!is_calibrated()) return snapshot;
    if (!job.blank.empty()) {
        repeated_.add(job.frame.index, job.blank);
        return snapshot;
    }
    TrackSummary& summary = run.summary;
    const Located& found = job.found;
    if (job.is_repeated) {
        ++summary.repeated;
    } else {
        summary.warm_frames += job.is_warm;
        summary.dimmest = std::min(summary.dimmest, job.light.span);
        summary.brightest = std::max(summary.brightest, job.light.span);
        summary.ms_per_frame.detect += job.ms.detect;
        summary.ms_per_frame.refine += job.ms.refine;
        summary.ms_per_frame.synthesis += job.ms.synthesis;
    }
    judge(found, job.frame, summary, repeated_, plan_);
    report(job, snapshot, summary);
    if (!options_.part) link(job, run, snapshot);
    if (bilayer_) summary.layers = bilayer_->summary();
    return snapshot;
}

/// Positions, errors and what else is known of each sphere.
void Tracker::report(const Job& job, Snapshot& snapshot, TrackSummary& summary) {
    if (job.synthesised) {
        snapshot.box.height = synthesis_->cell_height();
        synthesis_->report(*job.synthesised, options_.detection.border * model().disc.diameter,
                           snapshot);
        if (!job.is_repeated) add(*job.synthesised, job.frame.index, summary.synthesis);
        return;
    }
    const Located& found = job.found;
    snapshot.position = found.position;
    snapshot.quality = found.residual;
    snapshot.position_error = found.error;
    for (std::size_t j = 0; j < found.error.size(); ++j) {
        // Where the image model is wrong, its misfit limits the position beside the camera's noise,
        // and it is alike in neighbouring pixels.
        const double noise = found.noise * found.noise;
        const double misfit = std::max(0.0, found.residual[j] * found.residual[j] - noise);
        snapshot.position_error[j] *= std::sqrt(noise + found.correlation * misfit);
    }
    if (!options_.camera) {
        if (bilayer_) bilayer_->admit(snapshot, found.explained);
        return;
    }
    options_.camera->correct(snapshot);
    std::vector<double> explained = found.explained;
    keep_within(box_, snapshot, explained);
    if (bilayer_) bilayer_->admit(snapshot, explained);
}

void Tracker::link(const Job& job, Run& run, Snapshot& snapshot) {
    TrackSummary& summary = run.summary;
    const auto begin = Clock::now();
    snapshot.id = run.linker.link(job.position, snapshot.position, snapshot.position_error);
    // Without spheres nothing contradicts what is known of the layers.
    if (bilayer_ && snapshot.size() > 0) bilayer_->label(snapshot);
    summary.ms_per_frame.link += milliseconds_since(begin);
}

/// Links and writes what was found, and keeps it for the frames to come.
void Tracker::finish(Job& job, Run& run, const EachFrame& each_frame) {
    TrackSummary& summary = run.summary;
    if (job.frame.status != FrameStatus::ok) {
        ++(job.frame.status == FrameStatus::corrupt ? summary.frames_corrupt
                                                    : summary.frames_missing);
        repeated_.add(job.frame.index, job.frame.message);
        return;
    }
    const Snapshot snapshot = snapshot_of(job, run);
    run.particles += static_cast<double>(snapshot.size());
    ++summary.frames;
    const auto begin = Clock::now();
    run.long_tracks.write(snapshot);
    summary.ms_per_frame.write += milliseconds_since(begin);
    if (each_frame) each_frame(job.frame, snapshot, job.position);
    keep(job);
}

void Tracker::keep(Job& job) {
    if (!is_calibrated() || !job.is_usable()) return;
    previous_.step_rms =
        previous_.position == job.position - 1
            ? step_between(previous_.found.fitted, job.found.fitted, model().disc.diameter)
            : 0;
    previous_.position = job.position;
    previous_.counts = std::move(job.frame.image);
    previous_.found = std::move(job.found);
    if (job.synthesised) previous_.synthesised = std::move(job.synthesised);
}

TrackSummary Tracker::run(SnapshotSink& sink, Progress& progress, const EachFrame& each_frame,
                          const TrackResumption& resumption) {
    first_light_ = {};
    first_optics_.reset();
    begin_stretch();
    repeated_ = {};
    bilayer_.reset();
    if (options_.layers.height && !synthesis_) {
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
    const double diameter = is_calibrated() ? model().disc.diameter : 1.0;
    Run run{.linker = Linker(options_.link, diameter),
            .long_tracks = LongTracks(sink, options_.part ? 1 : options_.link.minimum_length,
                                      options_.link.memory),
            .summary = {},
            .next = frames_to_fit().begin};
    Linker& linker = run.linker;
    LongTracks& long_tracks = run.long_tracks;
    TrackSummary& summary = run.summary;
    if (resumption.from != nullptr) {
        restore(run, *resumption.from);
        progress.resume_at(run.next - frames_to_fit().begin);
    }
    // Stopped before it was found, a run that goes on has it to find still.
    if (!first_light_.has_reference) find_first_light();
    // Of a stream the end is known when it is reached.
    const auto is_more = [&] { return run.next < span().end; };
    while (is_more() && caught_signal() == 0) {
        const auto begin = Clock::now();
        if (run.next % options_.stretch == 0) begin_stretch();
        std::vector<Job> jobs = read(run);
        fit(jobs);
        for (Job& job : jobs) {
            progress.advance();
            job.position < span().begin ? keep(job) : finish(job, run, each_frame);
        }
        summary.ms_per_frame.wall += milliseconds_since(begin);
        if (resumption.save && is_more() && resumption.is_due()) {
            resumption.save(checkpoint(run));
        }
    }
    if (resumption.save && is_more()) resumption.save(checkpoint(run));
    long_tracks.finish();
    progress.finish();
    average(summary, run.particles, linker.summary());
    for (const std::string& warning : linker.warnings(diameter)) plan_.warn(warning);
    repeated_.say(source_.name(), plan_);
    warn_of(summary, plan_);
    return summary;
}

}  // namespace grainfield::tracking
