#include "app/track_command.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "app/interrupt_deadline.h"
#include "core/support/interrupt.h"
#include "io/output_file.h"
#include "pipelines/analyze/lengths.h"
#include "pipelines/track/kept_tracks.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using tracking::ImageModel;
using tracking::Polarity;
using tracking::Tracker;
using tracking::TrackSummary;

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
        "  time       {:.1f} ms a frame{} read {:.1f}, detect {:.1f}, refine {:.1f}, link {:.1f}, "
        "write {:.1f}; {} in all\n",
        ms.wall, summary.frames > 1 ? ", two side by side; of each" : ":", ms.read, ms.detect,
        ms.refine, ms.link, ms.write, format_duration(session.seconds()));
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
    facts["ms_per_frame"] = {{"detect", ms.detect}, {"refine", ms.refine}, {"link", ms.link},
                             {"read", ms.read},     {"write", ms.write},   {"wall", ms.wall}};
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
        WarningCode::apparent_diameter,
        fmt::format("lengths are in apparent disc diameters D = {:.3f} px; steel spheres: D is "
                    "about 0.88 a; give --sphere-diameter",
                    tracker.model().disc.diameter));
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
    describe(film_, own);
    own.integer("previews", previews_, "-", {0, 1000}, "frames kept in the output to look at");
    own.flag("resume", checkpoint_.resume, "go on from OUTPUT.checkpoint if it is there");
    own.number("checkpoint-every", checkpoint_.every, "min", {0, 1e6}, "time between checkpoints");
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : tracking::describe(tracking_)) tables.push_back(std::move(table));
    return tables;
}

void TrackCommand::plan_checkpoints(const pipelines::TrackCheckpoint& saved, std::int64_t frames,
                                    RunPlan& plan) const {
    if (saved.from() != nullptr) {
        plan.run("resume", "goes on from the checkpoint");
    } else if (checkpoint_.resume) {
        plan.run("resume", "there is no checkpoint: starts from the beginning");
    }
    if (frames > 1) {
        plan.run("checkpoints", fmt::format("every {:g} min", checkpoint_.every));
    } else {
        plan.skip("checkpoints", "one frame", "a log of what is written");
    }
}

Summary TrackCommand::run(Session& session) {
    require_output(session, output_);
    require_hdf5_name(output_);
    // A run that was resumed is recorded as the one that it completes.
    std::erase_if(session.configuration, [](const auto& o) { return o.first == "resume"; });
    std::optional<io::OutputFile> output;
    pipelines::TrackCheckpoint saved(session, pipelines::pictures_of(film_), output_, checkpoint_);
    if (!session.common.explain) {
        const bool replaces = session.common.force || saved.from() != nullptr;
        output.emplace(output_, replaces ? io::Overwrite::force : io::Overwrite::refuse);
    }
    session.start -= std::chrono::duration_cast<std::chrono::steady_clock::duration>(
        std::chrono::duration<double>(saved.seconds_before()));
    // Before the deadline, so that it outlives it.
    std::optional<pipelines::KeptTracks> tracks;
    pipelines::LastAct last_act(session, output_, [&saved] { return saved.advice(); });
    std::optional<InterruptDeadline> deadline;
    deadline.emplace([&](int) {
        last_act();
        saved.abandon();
    });
    tracking_.threads = session.threads();
    const pipelines::Film film = pipelines::open_film(session, film_, tracking_);
    pipelines::WatchedFrames& frames = *film.frames;
    tracking_.visible = film.visible;
    plan_checkpoints(saved, frames.count(), session.plan);

    Tracker tracker(frames, tracking_, session.plan);
    if (session.common.explain) return explanation(session.plan);
    warn_of_unit(tracker, session.plan);

    tracks.emplace(std::move(*output), tracker.info(), film.origin,
                   frames.count() > 1 ? saved.open_log() : nullptr);
    last_act.holds(&*tracks);
    pipelines::PreviewChoice choice(previews_, frames.count());
    std::vector<std::int64_t> previews;
    tracking::TrackResumption resumption{.from = saved.from()};
    if (saved.from() != nullptr) {
        for (const std::int64_t position : saved.previews()) {
            const Frame frame = frames.read(position);
            Snapshot awaited;
            awaited.frame = frame.index;
            tracks->add_preview(frame, awaited);
            choice.takes(position);
            previews.push_back(position);
        }
        tracks->replay();
    }
    if (frames.count() > 1) {
        resumption.is_due = [&] { return saved.is_due(); };
        resumption.save = [&](Checkpoint&& state) {
            saved.save(std::move(state), previews, session);
        };
    }
    Progress progress("tracking", frames.count(), "frames", session.common.verbosity());
    TrackSummary result = tracker.run(
        *tracks, progress,
        [&](const Frame& frame, const Snapshot& snapshot, std::int64_t position) {
            if (!choice.takes(position)) return;
            tracks->add_preview(frame, snapshot);
            previews.push_back(position);
        },
        resumption);
    deadline.reset();
    // Without the tracks that --minimum-length leaves out.
    result.particles_mean = tracks->particles_mean();
    const std::int64_t done = result.frames + result.frames_corrupt + result.frames_missing;
    const bool is_complete = done >= frames.count();
    if (caught_signal() != 0) {
        session.plan.warn(fmt::format("interrupted after {} of {} frames; '{}' holds those{}", done,
                                      frames.count(), output_, is_complete ? "" : saved.advice()));
    }
    if (result.frames > 0 && !has_residual(tracker, result)) {
        session.plan.warn("no residual is given: no spheres were found");
    }
    if (has_residual(tracker, result)) {
        const auto& disc = tracker.model().disc;
        tracks->add_curve(
            pipelines::calibration_curve(disc.diameter, disc.edge_width, result.residual_rms));
    }
    tracks->finish(session.record());
    session.outputs.push_back(output_);
    if (is_complete) saved.remove();
    return {.text = words(session, tracker, result),
            .facts = facts(tracker, result),
            .signal = caught_signal()};
}

}  // namespace grainfield::app
