#include "pipelines/live/live_job.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/interrupt.h"
#include "core/support/left_output.h"
#include "core/support/output_file.h"
#include "core/support/printable.h"
#include "pipelines/interrupt_deadline.h"
#include "pipelines/live/live_preview.h"
#include "pipelines/track/kept_tracks.h"
#include "pipelines/track/track_steps.h"

namespace grainfield::pipelines {

namespace {

constexpr std::uintmax_t hole_bytes = 1 << 26;  // more than the columns of a frame
constexpr double same_rate = 0.05;
constexpr double noted_silence = 30;            // [s]
constexpr std::int64_t enough_for_a_rate = 25;  // frames

void refuse_film_options(const TrackJobOptions& options, const Job& job) {
    const auto refuse = [](const char* option) {
        throw OptionError({.problem = "a live source is no film",
                           .actual = fmt::format("option '{}' is given", option),
                           .expected = {},
                           .suggestion = "leave it out"});
    };
    if (options.film.is_part) refuse("no-link");
    if (!options.film.part_of.empty()) refuse("part-of");
    if (options.resume.resume) refuse("resume");
    if (!job.inputs.empty()) {
        throw OptionError({.problem = "frames are to come from a film and from a live source",
                           .actual = fmt::format("input '{}'", job.inputs.front().string()),
                           .expected = "one of them",
                           .suggestion = "leave out option 'live', or the input"});
    }
}

/// Cameras and pipelines may be silent for ever without an end that can be seen. The first long
/// silence is said when it comes, as the run may wait on for days, and recorded.
class Silence {
 public:
    Silence(std::string source, const RunPlan& plan)
        : source_(std::move(source)), wording_(plan.wording()) {}

    /// Maybe in another thread.
    void say() {
        was_.store(true);
        const std::string said = text("the run waits");
        fmt::print(stderr, "warning: {}\n", printable(wording_ ? wording_(said) : said));
        std::fflush(stderr);
    }
    void record(RunPlan& plan) const {
        if (was_.load()) plan.warn(text("the run waited"));
    }

 private:
    std::string text(const char* what) const {
        return fmt::format(
            "'{}' gave nothing for {:g} s; {}; option 'live-silence' says after how long it ends",
            source_, noted_silence, what);
    }

    std::string source_;
    RunPlan::Wording wording_;
    std::atomic<bool> was_ = false;
};

std::unique_ptr<io::LiveFrames> open_source(const LiveJobOptions& live, const FilmOptions& film,
                                            std::function<void()> on_silence) {
    return io::open_live({.source = live.source,
                          .size = live.size,
                          .bit_depth = live.bit_depth,
                          .frames = film.frames.empty() ? io::kAllFrames : film.frames,
                          .queue = live.queue,
                          .waits = live.waits,
                          .longest_silence = live.longest_silence,
                          .noted_silence = noted_silence,
                          .on_silence = std::move(on_silence),
                          .fps = film.fps,
                          .max_pixels = film.max_pixels});
}

/// A run that cannot be taken up again: it has no film to go back to. The log is that of tracking
/// a film, which an earlier run may have left.
Resumable::Identity identity_of(const TrackJobOptions& options) {
    return {.kind = tracking::kTrackStateKind,
            .output = options.output,
            .log = ".snapshots",
            .configuration = {}};
}

/// Frames to look at: some in the output, the first of all and ever fewer later, as nobody knows
/// the last; and the newest one in a picture of its own.
class Pictures {
 public:
    Pictures(const LiveJobOptions& live, const TrackJobOptions& options, const TrajectoryInfo& info,
             Overwrite overwrite)
        : left_(options.previews) {
        if (live.preview.empty()) return;
        preview_.emplace(live.preview, overwrite, info.diameter,
                         info.time_unit == TimeUnit::second);
    }
    void correct(const tracking::CameraMap& map, const FrameSource& frames) {
        corrected_.emplace(map, frames.width(), frames.height());
    }

    void take(const Frame& frame, const Snapshot& found, std::int64_t position, KeptTracks& tracks,
              const io::LiveFrames& source) {
        const bool is_stored = left_ > 0 && position >= next_;
        const bool is_shown = preview_ && preview_->is_due();
        if (!is_stored && !is_shown) return;
        try_to([&] {
            Frame shown = frame;
            if (corrected_) shown.image = (*corrected_)(frame.image);
            if (is_stored) {
                tracks.add_preview(shown, found);
                --left_;
                next_ = std::max<std::int64_t>(10, 10 * next_);
            }
            if (is_shown) preview_->show(std::move(shown), found, source.counts().dropped);
        });
    }
    void finish(RunPlan& plan) {
        if (preview_) {
            try_to([&] { preview_->finish(); });
        }
        if (!failure_.empty()) plan.warn("the preview was given up: " + failure_);
    }

 private:
    /// A picture that cannot be made or written does not end the recording.
    template <class Work>
    void try_to(Work&& work) {
        try {
            work();
        } catch (const std::exception& error) {
            failure_ = error.what();
            preview_.reset();
            left_ = 0;
        }
    }

    std::int64_t left_;
    std::int64_t next_ = 0;  ///< position
    std::optional<LivePreview> preview_;
    std::optional<tracking::CorrectedPictures> corrected_;
    std::string failure_;
};

/// What there is of an output that cannot be written to its end. Closes it.
void leave_partial(std::optional<KeptTracks>& tracks, const std::filesystem::path& output,
                   Job& job) {
    std::filesystem::path partial = output;
    partial += ".partial";
    const std::string frames = counted(tracks->frames(), "frame");
    leave_temporary(partial);
    tracks.reset();
    // HDF5 reads no file that is shorter than its header says. A hole takes no space.
    std::error_code ignored;
    const auto length = std::filesystem::file_size(partial, ignored);
    if (!ignored) std::filesystem::resize_file(partial, length + hole_bytes, ignored);
    job.plan.warn(WarningCode::incomplete,
                  fmt::format("'{}' could not be completed; '{}' is left, with what could be "
                              "written of {}; 'grainfield export {} -o FILE.csv' reads it, "
                              "without a frame that is broken at its end",
                              output.string(), partial.string(), frames, partial.string()));
}

/// Makes what was tracked before a failure a complete file.
void complete_after_failure(std::optional<KeptTracks>& tracks, const std::filesystem::path& output,
                            Job& job) {
    Job kept = job;
    kept.plan.warn(WarningCode::incomplete,
                   fmt::format("tracking failed; '{}' holds the {} before", output.string(),
                               counted(tracks->frames(), "frame")));
    try {
        tracks->finish(kept.record());
    } catch (const std::exception&) {
        leave_partial(tracks, output, job);
        return;
    }
    job.plan = std::move(kept.plan);
    job.outputs.push_back(output);
}

/// Runs `work`, which writes tracks. What it wrote is kept if it fails; the failure is passed on.
template <class Work>
void run_or_keep(std::optional<KeptTracks>& tracks, std::optional<InterruptDeadline>& deadline,
                 const std::filesystem::path& output, Job& job, Work&& work) {
    try {
        work();
    } catch (const OutputError&) {
        deadline.reset();
        if (tracks->frames() > 0) leave_partial(tracks, output, job);
        throw;
    } catch (...) {
        deadline.reset();
        if (tracks->frames() > 0) complete_after_failure(tracks, output, job);
        throw;
    }
}

void warn_of_source(const io::LiveCounts& counts, const FrameSource& frames,
                    const LiveJobOptions& live, RunPlan& plan) {
    if (counts.dropped > 0) {
        plan.warn(fmt::format(
            "{} of {} frames were dropped, {:.1f} %: tracking is slower than the source; film "
            "slower, or choose a region; a source that can wait does with option 'live-wait'",
            counts.dropped, counts.captured,
            100 * static_cast<double>(counts.dropped) / static_cast<double>(counts.captured)));
    }
    if (!counts.damage.empty()) {
        plan.warn(fmt::format("{} {}: {}; the frames before are kept{}", frames.name(),
                              counts.is_silent ? "fell silent" : "is damaged", counts.damage,
                              counts.is_silent ? " (option 'live-silence')" : ""));
    }
    const double came = counts.rate();
    if (live.waits || counts.arrived < enough_for_a_rate || !(came > 0)) return;
    const auto said = frames.frame_rate();
    if (said && std::abs(came / *said - 1) > same_rate) {
        plan.warn(
            fmt::format("{:.4g} frames a second came, times are for {:.4g}: is that the "
                        "filming rate, and are none lost on the way?",
                        came, *said));
    }
}

}  // namespace

void describe(LiveJobOptions& options, OptionTable& table) {
    table.text("live", options.source,
               "in place of files: a V4L2 camera, a GStreamer pipeline, a FIFO, or - (standard "
               "input)");
    table.integers("live-size", options.size, "px", {1, 1e9},
                   "WIDTH,HEIGHT of raw frames in a FIFO or on standard input; auto: YUV4MPEG2",
                   {2, 2});
    table.integer("live-depth", options.bit_depth, "bit", {8, 16},
                  "with live-size: bits of a count; above 8 two bytes, the low one first");
    table.integer("live-queue", options.queue, "frames", {10, 100000},
                  "that may wait to be tracked; when it is full the oldest is dropped and counted");
    table.affects(Effect::work);
    table.flag("live-wait", options.waits,
               "the source waits where tracking is slower, and no frame is dropped");
    table.number(
        "live-silence", options.longest_silence, "s", {0, 1e6},
        "of silence, from the start on, after which the source has failed; 0: "
        "waits for ever; auto: so, with a warning where a camera or pipeline gives nothing "
        "for 30 s");
    table.affects(Effect::work);
    table.text("preview", options.preview,
               "with live: FILE.png or FILE.jpg with the newest frame and what was found, renewed "
               "each second");
    table.affects(Effect::work);
}

void plan_live(const LiveJobOptions& live, const TrackJobOptions& options, Job& job) {
    refuse_film_options(options, job);
    if (!live.preview.empty()) require_preview_name(live.preview);
    job.plan.run("live", fmt::format("frames of '{}', at most {} of them waiting; {}", live.source,
                                     live.queue,
                                     live.waits ? "then the source waits"
                                                : "then the oldest is dropped and counted"));
    job.plan.skip("checkpoints", "a live source cannot be gone back to",
                  "a log of what is written");
}

LiveJobResult track_live(const LiveJobOptions& live, const TrackJobOptions& options, Job& job) {
    options.lab.acceleration();  // contradictions are said before the work
    plan_live(live, options, job);
    TracksInWork work(job, identity_of(options), options);
    std::optional<KeptTracks>& tracks = work.tracks;
    std::optional<InterruptDeadline>& deadline = work.deadline;
    std::optional<tracking::Camera> camera;
    tracking::TrackOptions tracking = tracking_of(options, job, camera);
    Silence silence(live.source, job.plan);  // outlives the thread that reads
    std::unique_ptr<io::LiveFrames> opened =
        open_source(live, options.film, [&silence] { silence.say(); });
    io::LiveFrames& source = *opened;
    const Film film = live_film(std::move(opened), options.film, tracking, job);
    complete(tracking, film, camera);

    tracking::Tracker tracker(*film.frames, tracking, job.plan);
    require_calibration(tracker, *film.frames);
    warn_of_units(tracking, *film.frames, tracker, job.plan);
    // Its frame is there now, and gone when the source ends.
    std::optional<tracking::KeptCalibration> kept;
    if (!options.save_calibration.empty()) kept = tracker.to_keep();
    LiveJobResult result;
    TrackJobResult& track = result.track;
    track.camera = camera;
    track.spheres = spheres_of(tracker);
    if (!tracking.synthesis) track.bias = tracker.bias_decision();
    track.weighed = tracker.weighed();
    track.rate_source = rate_source(options, *film.frames);
    if (track.rate_source == RateSource::file) track.rate_source = RateSource::live;
    track.info = tracker.info();
    track.lab = lab_of(options.lab, camera, film, track.info);
    apply(track.lab, track.info);
    Pictures pictures(live, options, track.info, job.overwrite);
    if (tracking.camera) pictures.correct(*tracking.camera, *film.frames);
    work.resumable.finish();  // a checkpoint that was there is of the output that is replaced
    tracks.emplace(std::move(work.output), track.info, film.origin, nullptr);
    work.last_act.holds(&*tracks, job);

    Progress progress("tracking", 0, "frames", job.verbosity);
    run_or_keep(tracks, deadline, options.output, job, [&] {
        track.summary =
            tracker.run(*tracks, progress,
                        [&](const Frame& frame, const Snapshot& snapshot, std::int64_t position) {
                            pictures.take(frame, snapshot, position, *tracks, source);
                        });
    });
    deadline.reset();
    result.signal = caught_signal();
    result.counts = source.counts();
    // What breaks after a signal was ended by it, too.
    if (result.signal != 0) result.counts.damage.clear();
    pictures.finish(job.plan);
    silence.record(job.plan);
    track.summary.particles_mean = tracks->particles_mean();
    result.is_silent = result.counts.is_silent && result.signal == 0;
    result.untracked = result.counts.captured - result.counts.dropped - track.summary.frames -
                       track.summary.frames_corrupt;
    if (track.summary.frames == 0) throw_if_interrupted("tracking");
    warn_of_source(result.counts, source, live, job.plan);
    if (result.signal == 0 && !track.has_residual()) {
        refuse_without_spheres(track, result.counts.captured);
    }
    run_or_keep(tracks, deadline, options.output, job, [&] {
        add_curves(track, *tracks);
        tracks->finish(job.record());
    });
    job.outputs.push_back(options.output);
    if (kept) kept->optics = tracker.optics();
    if (kept) save_calibration(options.save_calibration, *kept, camera, job.overwrite, job);
    return result;
}

}  // namespace grainfield::pipelines
