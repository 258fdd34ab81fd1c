#include "app/track_command.h"

#include <csignal>

#include <fmt/format.h>

#include "app/lengths.h"
#include "app/watched_frames.h"
#include "core/interrupt.h"
#include "io/frame_files.h"
#include "io/frame_range.h"
#include "io/output_file.h"
#include "io/trajectory_file.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using tracking::ImageModel;
using tracking::Polarity;
using tracking::Tracker;
using tracking::TrackSummary;

std::string words(const Session& session, const Tracker& tracker, const TrackSummary& summary) {
    std::string text =
        fmt::format("{}: {} frames, {:.1f} particles per frame\n", session.outputs.front().string(),
                    summary.frames, summary.particles_mean);
    if (const std::int64_t bad = summary.frames_corrupt + summary.frames_missing; bad > 0) {
        text += fmt::format("  left out   {} frames: {} corrupt, {} missing\n", bad,
                            summary.frames_corrupt, summary.frames_missing);
    }
    if (tracker.is_calibrated()) {
        const ImageModel& model = tracker.model();
        text += fmt::format("  spheres    {}, diameter {:.3f} px, edge width {:.3f} px\n",
                            model.polarity == Polarity::dark ? "dark" : "bright",
                            model.disc.diameter, model.disc.edge_width);
        text += fmt::format("  residual   {:.4f} of the contrast (RMS)\n", summary.residual_rms);
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
    facts["residual_rms"] = summary.residual_rms;
    return facts;
}

}  // namespace

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
    own.integer("previews", previews_, "-", {0, 1000}, "frames kept in the output to look at");
    own.integer("max-pixels", max_pixels_, "px", {1, 1e11}, "largest frame accepted");
    own.flag("strict", strict_, "fail on the first bad frame instead of leaving it out");
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : tracking::describe(tracking_)) tables.push_back(std::move(table));
    return tables;
}

Summary TrackCommand::run(Session& session) {
    require_output(session, output_);
    const auto overwrite = session.common.force ? io::Overwrite::force : io::Overwrite::refuse;
    auto selected = io::select_frames(
        io::open_frames(session.inputs, {.fps = fps_, .max_pixels = max_pixels_}), frames_);
    WatchedFrames frames(std::move(selected), strict_ ? BadFrames::refuse : BadFrames::allow);
    for (const std::string& warning : frames.warnings()) session.plan.warn(warning);

    tracking_.threads = session.threads();
    Tracker tracker(frames, tracking_, session.plan);
    if (session.common.explain) return explanation(session.plan);

    io::TrajectoryWriter writer(output_, tracker.info(), overwrite);
    PreviewChoice choice(previews_, frames.count());
    std::vector<Preview> previews;
    Progress progress("tracking", frames.count(), "frames", session.common.verbosity());
    const TrackSummary result =
        tracker.run(writer, progress, [&](const Frame& frame, const Snapshot& snapshot) {
            if (choice.takes(frames.last_position())) previews.push_back({frame, snapshot, {}});
        });
    if (caught_signal() != 0) {
        session.plan.warn(fmt::format("interrupted after {} of {} frames; '{}' holds those",
                                      frames.last_position() + 1, frames.count(), output_));
    }
    for (const Preview& preview : previews) writer.add_preview(preview);
    if (tracker.is_calibrated()) {
        const auto& disc = tracker.model().disc;
        writer.add_curve(calibration_curve(disc.diameter, disc.edge_width, result.residual_rms));
    }
    writer.finish(session.record());
    session.outputs.push_back(output_);
    return {.text = words(session, tracker, result),
            .facts = facts(tracker, result),
            .signal = caught_signal()};
}

}  // namespace grainfield::app
