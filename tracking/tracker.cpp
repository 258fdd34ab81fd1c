#include "tracking/tracker.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/parallel.h"
#include "tracking/film_model.h"
#include "tracking/run_clock.h"
#include "tracking/track_plan.h"
#include "tracking/warm_start.h"

namespace grainfield::tracking {

namespace {

/// The optics of a kept calibration, if they hold here.
std::optional<FilmOptics> usable_optics(const KeptCalibration& kept, const FilmSynthesis& synthesis,
                                        RunPlan& plan) {
    if (!kept.optics) {
        plan.run("optics", "of the spheres: estimated from the first frame");
        return std::nullopt;
    }
    const std::string mismatch = synthesis.mismatch(*kept.optics);
    if (mismatch.empty()) {
        plan.run("optics", "of the spheres: as kept with the calibration");
        return kept.optics;
    }
    plan.warn(
        fmt::format("the kept optics do not hold here: {}. They are estimated from the "
                    "first frame",
                    mismatch));
    return std::nullopt;
}

}  // namespace

Tracker::Tracker(FrameSource& source, const TrackOptions& options, RunPlan& plan)
    : source_(source), options_(options), plan_(plan), threads_(thread_count(options.threads)) {
    require_consistent(options);
    box_.origin = {-0.5, -0.5};
    box_.length = {static_cast<double>(source.width()), static_cast<double>(source.height())};
    if (options.camera) box_ = options.camera->box(source.width(), source.height());
    options_.detection = detection_of(options);
    // Mirrors before a panel are dark.
    PolarityChoice& polarity = options_.calibration.polarity;
    if ((options.synthesis || options.correct_bias.value_or(false)) && !options.kept &&
        polarity == PolarityChoice::automatic) {
        polarity = PolarityChoice::dark;
    }
    FilmModel film = model_of_film(source, options_, threads_, plan);
    film_ = std::move(film.film);
    binning_reason_ = std::move(film.binning_reason);
    if (!is_calibrated()) return;
    if (options_.keeps) {
        // Films that use it do not know where the spheres of this one were.
        film_.calibration->positions.clear();
        film_.frame = -1;
    }
    model_ = fitted_model().in_pixels();
    const Binning blocks = binning();
    fit_detection_ = in_blocks(options_.detection, blocks);
    fit_refinement_ = in_blocks(options_.refinement, blocks);
    fit_visible_ = options_.visible.blocks(blocks.factor);
    warn_of_unusual_size(model().disc.diameter, options_, plan);
    const std::int64_t count = source.count();
    const int lanes = static_cast<int>(std::min<std::int64_t>(kSideBySide, count));
    for (int lane = 0; lane < lanes; ++lane) {
        lanes_.push_back({Locator(blocks.blocks(source.width()), blocks.blocks(source.height()),
                                  fitted_model(), threads_),
                          IlluminationFollower(fitted_model(), fit_visible_)});
        lanes_.back().locator.set_visible(fit_visible_);
        lanes_.back().locator.expect_misfit(model().residual_rms);
    }
    plan_frames(model(), options_, count, plan);
    if (options_.camera) plan_camera(*options_.camera, box_, source.width(), source.height(), plan);
    if (options_.synthesis) {
        SynthesisOptions& synthesis = options_.synthesis_options;
        synthesis.height = options_.layers.height.value_or(synthesis.height);
        synthesis_.emplace(model(), *options_.sphere_diameter,
                           options_.layers.camera_distance.value_or(0), synthesis);
        kept_optics_ = usable_optics(options_.kept.value_or(KeptCalibration{}), *synthesis_, plan);
    }
    plan_heights(options_, plan);
    bias_ = std::move(film.bias.correction);
    bias_decision_ = std::move(film.bias.decision);
    if (bias_) {
        for (Lane& lane : lanes_) lane.locator.set_correction(*bias_);
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

/// Whether the second of two frames side by side would begin cold, and after the first one it
/// would not.
bool Tracker::is_far_for_two() const {
    const double most = kWarmStep * fitted_model().disc.diameter;
    return previous_.step_rms <= most &&
           static_cast<double>(kSideBySide) * previous_.step_rms > most;
}

/// The frames that are fitted next, side by side; alone until one has said what the light of the
/// others is compared with, and where spheres go far. A run that is taken up goes on where such a
/// group begins.
std::vector<Tracker::Job> Tracker::read(Run& run) {
    const auto begin = RunClock::now();
    const std::int64_t first = run.next;
    const std::int64_t in_stretch = first % options_.stretch;
    const bool is_alone =
        in_stretch == 0 || !light_.has_reference || (is_calibrated() && is_far_for_two());
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
        if (synthesis_ && !first_optics_) synthesise(jobs);
    }
}

void Tracker::begin_stretch() {
    previous_ = {};
    if (first_optics_) previous_.synthesised = FilmSynthesis::leaving(*first_optics_);
    light_ = first_light_;
}

void Tracker::keep(Job& job) {
    if (!is_calibrated() || !job.is_usable()) return;
    previous_.step_rms =
        previous_.position == job.position - 1
            ? step_between(previous_.found.fitted, job.found.fitted, fitted_model().disc.diameter)
            : 0;
    previous_.position = job.position;
    previous_.counts = std::move(job.frame.image);
    // Of two frames side by side the first one may have seen it alone.
    const bool knows = job.found.warm && previous_.found.doubtful_are_false;
    previous_.found = std::move(job.found);
    previous_.found.doubtful_are_false = previous_.found.doubtful_are_false || knows;
    if (job.synthesised) previous_.synthesised = std::move(job.synthesised);
}

TrackSummary Tracker::run(SnapshotSink& sink, Progress& progress, const EachFrame& each_frame,
                          const TrackResumption& resumption) {
    first_light_ = {};
    first_optics_ = kept_optics_;
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
    const auto track = [&] {
        while (is_more() && caught_signal() == 0) {
            const auto begin = RunClock::now();
            if (run.next % options_.stretch == 0) begin_stretch();
            std::vector<Job> jobs = read(run);
            fit(jobs);
            if (synthesis_) synthesise(jobs);
            for (Job& job : jobs) {
                progress.advance();
                job.position < span().begin ? keep(job) : finish(job, run, each_frame);
            }
            const double milliseconds = milliseconds_since(begin);
            summary.ms_per_frame.wall += milliseconds;
            const bool is_slow = milliseconds > resumption.slow;
            if (resumption.save && is_more() && (is_slow || resumption.is_due())) {
                resumption.save(checkpoint(run));
            }
        }
    };
    try {
        track();
    } catch (const OutputError&) {
        throw;
    } catch (...) {
        // What waits for longer tracks is written; a run that can be taken up keeps it otherwise.
        if (!resumption.save) long_tracks.finish();
        throw;
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
