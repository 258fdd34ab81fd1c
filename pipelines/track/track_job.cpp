#include "pipelines/track/track_job.h"

#include <system_error>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/h5/snapshot_log.h"
#include "io/input_record.h"
#include "io/joined_films.h"
#include "pipelines/interrupt_deadline.h"
#include "pipelines/track/film_part.h"
#include "pipelines/track/kept_tracks.h"
#include "pipelines/track/track_steps.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;
using tracking::Tracker;

/// The frames by number and bytes, in words. Their content is not read for it: calibration shows
/// whether it is the same film.
std::string film_in_words(const std::vector<fs::path>& inputs) {
    if (inputs.empty()) return "none";
    std::uintmax_t bytes = 0;
    for (const fs::path& input : inputs) {
        std::error_code unreadable;
        const std::uintmax_t size = fs::file_size(input, unreadable);
        if (!unreadable) bytes += size;
    }
    return fmt::format("{} from '{}', {} bytes",
                       counted(static_cast<std::int64_t>(inputs.size()), "file"),
                       inputs.front().filename().string(), bytes);
}

/// All that the result depends on: options, the content of the pictures that they name, the film.
Resumable::Identity identity_of(const TrackJobOptions& options, const Job& job) {
    FilmOptions film = options.film;
    tracking::TrackOptions tracking = options.tracking;
    std::vector<OptionTable> tables{OptionTable("")};
    describe(film, tables.front());
    for (OptionTable& table : tracking::describe(tracking)) tables.push_back(std::move(table));
    Configuration compared = physics_of(tables);
    compared.emplace_back("previews", std::to_string(options.previews));
    compared.emplace_back("no-link", options.film.is_part ? "true" : "false");
    compared.emplace_back("part-of", options.film.part_of);
    compared.emplace_back("seed", std::to_string(job.seed));
    std::vector<std::string> files = pictures_of(options.film);
    if (!options.calibration.empty()) files.push_back(options.calibration);
    if (!options.camera.empty()) files.push_back(options.camera);
    compared.emplace_back("calibration is kept", options.save_calibration.empty() ? "no" : "yes");
    for (const std::string& picture : files) {
        const RunRecord::Input record = io::describe_input(picture);
        throw_if_interrupted("tracking");
        compared.emplace_back(fmt::format("content of '{}'", picture),
                              fmt::format("{} bytes, {}", record.bytes, record.checksum));
    }
    compared.emplace_back("input", film_in_words(job.inputs));
    return {.kind = tracking::kTrackStateKind,
            .output = options.output,
            .log = ".snapshots",
            .configuration = std::move(compared),
            .record = options.output};
}

void plan_checkpoints(Resumable& resumable, std::int64_t frames, RunPlan& plan) {
    if (frames > 1) {
        resumable.explain();
    } else {
        plan.skip("checkpoints", "one frame", "a log of what is written");
    }
}

std::vector<std::int64_t> recorded_previews(const Checkpoint& checkpoint) {
    const auto found = checkpoint.integers.find("previews");
    return found == checkpoint.integers.end() ? std::vector<std::int64_t>{} : found->second;
}

/// Says which frames the file holds, the first `done` of those asked for, and how they were
/// measured.
PartRecord record_of(const Film& film, const tracking::TrackOptions& options,
                     const Tracker& tracker, std::int64_t done) {
    PartRecord part;
    part.film = film.part->film;
    part.span = film.part->span;
    part.origin = film.origin;
    part.span.end = part.span.begin + done;
    part.size = {static_cast<double>(film.frames->width()),
                 static_cast<double>(film.frames->height())};
    if (tracker.is_calibrated()) part.disc_diameter = tracker.model().disc.diameter;
    part.sphere_diameter = options.sphere_diameter;
    // Synthesis gives layers by itself.
    if (!options.synthesis) part.height = options.layers.height;
    part.camera_distance = options.layers.camera_distance.value_or(0);
    part.calibration = tracker.calibration_numbers();
    return part;
}

void plan_part(const Film& film, const Tracker& tracker, RunPlan& plan) {
    if (!film.part) return;
    const FrameSpan span = film.part->span;
    const std::int64_t before = span.begin - tracker.frames_to_fit().begin;
    plan.run("part",
             fmt::format("frames {} to {} of the {} of the film; calibration, background and light "
                         "are those of the whole film{}",
                         film.part->film.first + span.begin * film.part->film.step,
                         film.part->film.first + (span.end - 1) * film.part->film.step,
                         film.part->film.count,
                         before == 0 ? ""
                                     : fmt::format("; {} before it are fitted as well, as they "
                                                   "begin the stretch (track.stretch)",
                                                   counted(before, "frame"))));
}

/// Puts into the tracks what an interrupted run had, and hands the tracker what it goes on from.
class Resumption {
 public:
    Resumption(Resumable& resumable, KeptTracks& tracks, PreviewChoice& choice)
        : resumable_(resumable), tracks_(tracks), choice_(choice) {}

    /// Previews are to be as a camera without lens and tilt has them.
    void correct(const tracking::CameraMap& map, const FrameSource& frames) {
        corrected_.emplace(map, frames.width(), frames.height());
    }

    void replay(FrameSource& frames) {
        if (resumable_.from() == nullptr) return;
        for (const std::int64_t position : recorded_previews(*resumable_.from())) {
            const Frame frame = frames.read(position);
            Snapshot awaited;
            awaited.frame = frame.index;
            take(frame, awaited, position);
        }
        tracks_.replay();
    }

    void take(const Frame& frame, const Snapshot& snapshot, std::int64_t position) {
        if (!choice_.takes(position)) return;
        Frame shown = frame;
        if (corrected_) shown.image = (*corrected_)(frame.image);
        tracks_.add_preview(shown, snapshot);
        previews_.push_back(position);
    }

    tracking::TrackResumption of_tracker(std::int64_t frames) {
        tracking::TrackResumption resumption{.from = resumable_.from()};
        if (frames <= 1) return resumption;
        resumption.is_due = [this] { return resumable_.is_due(); };
        resumption.save = [this](Checkpoint&& state) {
            state.integers["previews"] = previews_;
            resumable_.save(std::move(state));
        };
        return resumption;
    }

 private:
    Resumable& resumable_;
    KeptTracks& tracks_;
    PreviewChoice& choice_;
    std::optional<tracking::CorrectedPictures> corrected_;
    std::vector<std::int64_t> previews_;
};

/// The lab's units and numbers do not change positions, but stand in the output, and `strict`
/// decides whether there is one: a complete output of other ones is no output of this job.
void mind_what_is_recorded(Job& job) {
    LabUnits lab;
    OptionTable recorded("");
    describe(lab, recorded);
    std::erase_if(job.indifferent, [&](const std::string& name) {
        return name == "strict" || std::ranges::any_of(recorded.rows(), [&](const Option& option) {
                   return option.name == name;
               });
    });
}

}  // namespace

void plan_tracking(const TrackJobOptions& options, Job& job) {
    options.lab.acceleration();  // contradictions are said before the work
    job.inputs = io::recording_files(job.inputs);
    Resumable resumable(job, identity_of(options, job), options.resume);
    std::optional<tracking::Camera> camera;
    tracking::TrackOptions tracking = tracking_of(options, job, camera);
    const Film film = open_film(job, options.film, tracking);
    complete(tracking, film, camera);
    plan_checkpoints(resumable, film.frames->count(), job.plan);
    tracking.corrects_bias = false;
    const Tracker tracker(*film.frames, tracking, job.plan);
    plan_part(film, tracker, job.plan);
}

TrackJobResult track_film(const TrackJobOptions& options, Job& job) {
    const std::string name = options.output.string();
    options.lab.acceleration();  // contradictions are said before the work, as names that are taken
    mind_what_is_recorded(job);
    job.inputs = io::recording_files(job.inputs);
    TracksInWork work(job, identity_of(options, job), options);
    Resumable& resumable = work.resumable;
    if (!options.save_calibration.empty()) {
        const OutputFile checked(options.save_calibration, resumable.overwrite());
    }
    std::optional<io::SnapshotLog>& log = work.log;
    std::optional<KeptTracks>& tracks = work.tracks;
    std::optional<tracking::Camera> camera;
    tracking::TrackOptions tracking = tracking_of(options, job, camera);
    const Film film = open_film(job, options.film, tracking);
    WatchedFrames& frames = *film.frames;
    complete(tracking, film, camera);
    const std::int64_t wanted = film.part ? film.part->span.size() : frames.count();
    plan_checkpoints(resumable, frames.count(), job.plan);
    Tracker tracker(frames, tracking, job.plan);
    require_calibration(tracker, frames);
    plan_part(film, tracker, job.plan);
    warn_of_units(tracking, frames, tracker, job.plan);
    if (frames.count() > 1) {
        resumable.start();
        log.emplace(resumable.log());
    }
    TrajectoryInfo info = tracker.info();
    const LabUnits lab = lab_of(options.lab, camera, film, info);
    apply(lab, info);
    tracks.emplace(std::move(work.output), info, film.origin, log ? &*log : nullptr);
    work.last_act.holds(&*tracks, job);
    PreviewChoice choice(options.previews, frames.count());
    if (film.part) choice.begin_at(film.part->span.begin);
    Resumption resumption(resumable, *tracks, choice);
    if (tracking.camera) resumption.correct(*tracking.camera, frames);
    resumption.replay(frames);

    Progress progress("tracking", tracker.frames_to_fit().size(), "frames", job.verbosity);
    TrackJobResult result;
    result.info = info;
    result.rate_source = rate_source(options, frames);
    result.lab = lab;
    result.camera = camera;
    result.summary = tracker.run(
        *tracks, progress,
        [&](const Frame& frame, const Snapshot& snapshot, std::int64_t position) {
            resumption.take(frame, snapshot, position);
        },
        resumption.of_tracker(frames.count()));
    work.deadline.reset();
    result.signal = caught_signal();
    result.spheres = spheres_of(tracker);
    result.weighed = tracker.weighed();
    if (!tracking.synthesis && tracker.is_calibrated()) result.bias = tracker.bias_decision();
    tracking::TrackSummary& summary = result.summary;
    // Without the tracks that are too short to be written.
    summary.particles_mean = tracks->particles_mean();
    const std::int64_t done = summary.frames + summary.frames_corrupt + summary.frames_missing;
    const bool is_complete = done >= wanted;
    if (result.signal != 0) {
        Warning warning =
            resumable.interrupted(static_cast<double>(done), static_cast<double>(wanted), "frames",
                                  fmt::format("; '{}' holds those", name));
        if (!is_complete) warning.code = WarningCode::incomplete;
        job.plan.warn(std::move(warning));
    }
    if (is_complete && result.signal == 0 && !result.has_residual()) {
        resumable.finish();
        refuse_without_spheres(result, done);
    }
    add_curves(result, *tracks);
    if (film.part) {
        for (const Curve& curve : curves_of(record_of(film, tracking, tracker, done))) {
            tracks->add_curve(curve);
        }
    }
    tracks->finish(job.record());
    job.outputs.push_back(options.output);
    if (!options.save_calibration.empty()) {
        save_calibration(options.save_calibration, tracker.to_keep(), camera, resumable.overwrite(),
                         job);
    }
    if (is_complete) resumable.finish();
    return result;
}

}  // namespace grainfield::pipelines
