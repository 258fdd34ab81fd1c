#include "app/track_command.h"

#include <algorithm>
#include <cstdio>
#include <mutex>
#include <utility>

#include <fmt/format.h>

#include "app/interrupt_deadline.h"
#include "app/lengths.h"
#include "app/watched_frames.h"
#include "core/errors.h"
#include "core/interrupt.h"
#include "io/frame_files.h"
#include "io/frame_range.h"
#include "io/frame_region.h"
#include "io/output_file.h"
#include "io/read_ahead.h"
#include "io/trajectory_file.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using tracking::ImageModel;
using tracking::Polarity;
using tracking::Tracker;
using tracking::TrackSummary;

/// The file being written, shared with the thread that closes it if a signal finds the work stuck
/// in one frame. Counts what is written: tracks that are too short are not.
class KeptTracks : public SnapshotSink {
 public:
    /// `origin`: where the frames begin in those of the source [px]; previews stay with their
    /// pictures.
    KeptTracks(io::OutputFile output, const TrajectoryInfo& info, Vec2 origin)
        : writer_(std::move(output), info), origin_(origin) {}

    void write(const Snapshot& snapshot) override {
        const std::lock_guard lock(mutex_);
        if (origin_ == Vec2{}) {
            writer_.write(snapshot);
        } else {
            Snapshot moved = snapshot;
            for (Vec2& p : moved.position) p += origin_;
            moved.box.origin += origin_;
            writer_.write(moved);
        }
        ++frames_;
        particles_ += static_cast<double>(snapshot.size());
        last_frame_ = snapshot.frame;
        for (Preview& preview : previews_) {
            if (preview.snapshot.frame == snapshot.frame) preview.snapshot = snapshot;
        }
    }

    /// `found`: what the tracker found in it; replaced by what is written of that, if it comes
    /// later.
    void add_preview(const Frame& frame, const Snapshot& found) {
        const std::lock_guard lock(mutex_);
        previews_.push_back({frame, found, {}});
    }

    void add_curve(const Curve& curve) {
        const std::lock_guard lock(mutex_);
        writer_.add_curve(curve);
    }

    void finish(const RunRecord& record) {
        const std::lock_guard lock(mutex_);
        for (const Preview& preview : previews_) {
            // Frames that still waited for their tracks to grow are not in the file.
            if (preview.snapshot.frame <= last_frame_) writer_.add_preview(preview);
        }
        writer_.finish(record);
    }

    std::int64_t frames() const {
        const std::lock_guard lock(mutex_);
        return frames_;
    }
    double particles_mean() const {
        return particles_ / static_cast<double>(std::max<std::int64_t>(frames_, 1));
    }

 private:
    mutable std::mutex mutex_;
    io::TrajectoryWriter writer_;
    Vec2 origin_;
    std::vector<Preview> previews_;
    std::int64_t frames_ = 0;
    std::int64_t last_frame_ = -1;
    double particles_ = 0;
};

/// What a signal leaves if the work does not stop by itself: the frames that are written.
class LastAct {
 public:
    LastAct(Session session, std::string output)
        : session_(std::move(session)), output_(std::move(output)) {}

    void holds(KeptTracks* tracks) {
        const std::lock_guard lock(mutex_);
        tracks_ = tracks;
    }

    void operator()() {
        const std::lock_guard lock(mutex_);
        if (tracks_ == nullptr || tracks_->frames() == 0) {
            fmt::print(stderr,
                       "error: tracking interrupted in the first frame; '{}' was not written.\n",
                       output_);
            return;
        }
        session_.plan.warn(fmt::format("interrupted within a frame; '{}' holds the {} before it",
                                       output_, counted(tracks_->frames(), "frame")));
        tracks_->finish(session_.record());
        fmt::print(stderr, "warning: {}\n", session_.plan.warnings().back());
    }

 private:
    std::mutex mutex_;
    Session session_;
    std::string output_;
    KeptTracks* tracks_ = nullptr;
};

bool has_residual(const Tracker& tracker, const TrackSummary& summary) {
    return tracker.is_calibrated() && summary.particles_mean > 0;
}

std::string words(const Session& session, const Tracker& tracker, const TrackSummary& summary) {
    std::string text =
        fmt::format("{}: {}, {:.1f} particles per frame\n", session.outputs.front().string(),
                    counted(summary.frames, "frame"), summary.particles_mean);
    if (const std::int64_t bad = summary.frames_corrupt + summary.frames_missing; bad > 0) {
        text += fmt::format("  left out   {}: {} corrupt, {} missing\n", counted(bad, "frame"),
                            summary.frames_corrupt, summary.frames_missing);
    }
    if (tracker.is_calibrated()) {
        const ImageModel& model = tracker.model();
        text += fmt::format("  spheres    {}, diameter {:.3f} px, edge width {:.3f} px\n",
                            model.polarity == Polarity::dark ? "dark" : "bright",
                            model.disc.diameter, model.disc.edge_width);
        if (has_residual(tracker, summary))
            text +=
                fmt::format("  residual   {:.4f} of the contrast (RMS)\n", summary.residual_rms);
    }
    if (summary.layers.spheres > 0) {
        text += fmt::format("  layers     {} of {} positions named, {} left out as impossible\n",
                            summary.layers.labelled, summary.layers.spheres,
                            summary.layers.rejected_pairs + summary.layers.rejected_triples);
    }
    const auto& ms = summary.ms_per_frame;
    text += fmt::format(
        "  time       {:.1f} ms a frame: read {:.1f}, detect {:.1f}, refine {:.1f}, link {:.1f}, "
        "write {:.1f}; {} in all\n",
        ms.read + ms.detect + ms.refine + ms.link + ms.write, ms.read, ms.detect, ms.refine,
        ms.link, ms.write, format_duration(session.seconds()));
    for (const PlannedStage& stage : session.plan.skipped()) {
        text += fmt::format("  skipped    {}: {}\n", stage.stage, stage.reason);
    }
    return text;
}

ordered_json facts(const Tracker& tracker, const TrackSummary& summary) {
    ordered_json facts;
    facts["frames"] = summary.frames;
    facts["frames_corrupt"] = summary.frames_corrupt;
    facts["frames_missing"] = summary.frames_missing;
    facts["particles_mean"] = summary.particles_mean;
    facts["diameter_px"] = nullptr;
    facts["edge_width_px"] = nullptr;
    if (tracker.is_calibrated()) {
        facts["diameter_px"] = tracker.model().disc.diameter;
        facts["edge_width_px"] = tracker.model().disc.edge_width;
    }
    const auto& ms = summary.ms_per_frame;
    facts["ms_per_frame"] = {{"detect", ms.detect},
                             {"refine", ms.refine},
                             {"link", ms.link},
                             {"read", ms.read},
                             {"write", ms.write}};
    facts["residual_rms"] = nullptr;
    if (has_residual(tracker, summary)) facts["residual_rms"] = summary.residual_rms;
    facts["layers"] = nullptr;
    if (summary.layers.spheres > 0) {
        const auto& layers = summary.layers;
        facts["layers"] = {{"labelled", layers.labelled},
                           {"positions", layers.spheres},
                           {"contradictory", layers.contradictory},
                           {"rejected_pairs", layers.rejected_pairs},
                           {"rejected_triples", layers.rejected_triples}};
    }
    facts["unsettled"] = summary.unsettled;
    facts["rejected"] = summary.rejected;
    facts["warm_frames"] = summary.warm_frames;
    facts["repeated_frames"] = summary.repeated;
    facts["contrast_range"] = {summary.dimmest, summary.brightest};
    return facts;
}

}  // namespace

void TrackCommand::warn_of_unit(const Tracker& tracker, RunPlan& plan) const {
    if (tracking_.sphere_diameter || !tracker.is_calibrated()) return;
    plan.warn(
        fmt::format("{} = {:.3f} px; steel spheres: D is about 0.88 a; give --sphere-diameter",
                    apparent_diameter_warning, tracker.model().disc.diameter));
}

std::string TrackCommand::purpose() const {
    return "find and follow the spheres in a video or in images";
}

Command::Inputs TrackCommand::inputs() const {
    return {.placeholder = "VIDEO|IMAGE...",
            .meaning = "one video, or images (PNG, TIFF, JPEG, BMP, PGM) in order",
            .count = Count::many};
}

std::vector<OptionTable> TrackCommand::options() {
    OptionTable own("");
    own.text("output", output_, "trajectory file to write (H5MD)");
    own.number("fps", fps_, "1/s", {1e-9, 1e9}, "frame rate; auto: as the file says");
    own.text("frames", frames_, "which frames, as FIRST:END:STEP");
    own.text("region", region_, "part of the frames to track, as X,Y,WIDTH,HEIGHT [px]");
    own.text("flat-field", flat_field_, "picture of the empty, lit cell to divide the frames by");
    own.integer("previews", previews_, "-", {0, 1000}, "frames kept in the output to look at");
    own.integer("max-pixels", max_pixels_, "px", {1, 1e11}, "largest frame accepted");
    own.flag("strict", strict_, "fail on the first bad frame instead of leaving it out");
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : tracking::describe(tracking_)) tables.push_back(std::move(table));
    return tables;
}

std::unique_ptr<FrameSource> TrackCommand::corrected(
    std::unique_ptr<FrameSource> frames, const std::optional<io::FrameRegion>& region) const {
    if (!flat_field_.empty()) {
        const auto flat = io::open_frames({flat_field_}, {.fps = {}, .max_pixels = max_pixels_});
        const Frame frame = flat->read(0);
        if (frame.status != FrameStatus::ok) {
            throw InputError({.problem = fmt::format("cannot use '{}' as flat field", flat_field_),
                              .actual = frame.message,
                              .expected = "a whole picture",
                              .suggestion = {}});
        }
        frames = io::flatten_frames(std::move(frames), frame.image);
    }
    return region ? io::crop_frames(std::move(frames), *region) : std::move(frames);
}

Summary TrackCommand::run(Session& session) {
    require_output(session, output_);
    require_hdf5_name(output_);
    const auto overwrite = session.common.force ? io::Overwrite::force : io::Overwrite::refuse;
    std::optional<io::OutputFile> output;
    if (!session.common.explain) output.emplace(output_, overwrite);
    // Before the deadline, so that it outlives it.
    std::optional<KeptTracks> tracks;
    LastAct last_act(session, output_);
    std::optional<InterruptDeadline> deadline;
    deadline.emplace([&last_act](int) { last_act(); });
    auto selected = io::select_frames(
        io::open_frames(session.inputs, {.fps = fps_, .max_pixels = max_pixels_}), frames_);
    const auto region = io::parse_region(region_, selected->width(), selected->height());
    const Vec2 origin =
        region ? Vec2{static_cast<double>(region->x), static_cast<double>(region->y)} : Vec2{};
    WatchedFrames frames(io::read_ahead(corrected(std::move(selected), region)),
                         strict_ ? BadFrames::refuse : BadFrames::allow);
    for (const std::string& warning : frames.warnings()) session.plan.warn(warning);

    tracking_.threads = session.threads();
    Tracker tracker(frames, tracking_, session.plan);
    if (session.common.explain) return explanation(session.plan);
    warn_of_unit(tracker, session.plan);

    tracks.emplace(std::move(*output), tracker.info(), origin);
    last_act.holds(&*tracks);
    PreviewChoice choice(previews_, frames.count());
    Progress progress("tracking", frames.count(), "frames", session.common.verbosity());
    TrackSummary result =
        tracker.run(*tracks, progress, [&](const Frame& frame, const Snapshot& snapshot) {
            if (choice.takes(frames.last_position())) tracks->add_preview(frame, snapshot);
        });
    deadline.reset();
    // Without the tracks that --minimum-length leaves out.
    result.particles_mean = tracks->particles_mean();
    if (caught_signal() != 0) {
        session.plan.warn(fmt::format("interrupted after {} of {} frames; '{}' holds those",
                                      frames.last_position() + 1, frames.count(), output_));
    }
    if (result.frames > 0 && !has_residual(tracker, result)) {
        session.plan.warn("no residual is given: no spheres were found");
    }
    if (has_residual(tracker, result)) {
        const auto& disc = tracker.model().disc;
        tracks->add_curve(calibration_curve(disc.diameter, disc.edge_width, result.residual_rms));
    }
    tracks->finish(session.record());
    session.outputs.push_back(output_);
    return {.text = words(session, tracker, result),
            .facts = facts(tracker, result),
            .signal = caught_signal()};
}

}  // namespace grainfield::app
