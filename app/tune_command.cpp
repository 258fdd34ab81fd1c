#include "app/tune_command.h"

#include <filesystem>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "analysis/analysis.h"
#include "app/figures_folder.h"
#include "core/errors.h"
#include "core/support/interrupt.h"
#include "io/output_file.h"
#include "pipelines/interrupt_deadline.h"
#include "pipelines/tune/tune_report.h"

namespace grainfield::app {

namespace {

using tracking::Survey;

/// The settings as a file beside the page.
std::filesystem::path settings_file(const std::filesystem::path& html) {
    return html.parent_path() / (html.stem().string() + ".toml");
}

Results run_of(const Session& session, const TrajectoryInfo& info, std::string label) {
    Results run;
    run.source = info;
    run.label = std::move(label);
    run.record = session.record();
    run.record.skipped.clear();  // the page takes them from the plan
    run.record.warnings.clear();
    return run;
}

}  // namespace

std::string TuneCommand::purpose() const {
    return "preview what track finds with its settings, and suggest better ones";
}

Command::Inputs TuneCommand::inputs() const {
    return {.placeholder = "VIDEO|IMAGE...",
            .meaning = "one video, or images, as for track",
            .count = Count::many};
}

std::vector<OptionTable> TuneCommand::options() {
    OptionTable own("");
    own.text("output", output_, "HTML page to write; settings and figures go beside it");
    own.text("title", report_.title, "title of the page");
    own.flag("figures", report_.figures, "write every plot and table as SVG, PDF and CSV too");
    own.integer("samples", samples_, "frames", {1, 20}, "looked at, spread over the film");
    describe(film_, own);
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : tracking::describe(tracking_)) tables.push_back(std::move(table));
    return tables;
}

Summary TuneCommand::run(Session& session) {
    return pipelines::run_or_discard("tuning", output_, [&] { return work(session); });
}

std::vector<Survey> TuneCommand::look(Session& session, pipelines::WatchedFrames& frames,
                                      const tracking::Tracker& tracker,
                                      std::vector<Preview>& previews) const {
    tracking::Surveyor surveyor(tracker.model(), tracking_, frames.width(), frames.height());
    pipelines::PreviewChoice choice(samples_, frames.count());
    std::vector<Survey> surveys;
    for (std::int64_t i = 0; i < frames.count(); ++i) {
        throw_if_interrupted("tuning");
        if (!choice.takes(i)) continue;
        Frame frame = frames.read(i);
        if (frame.status != FrameStatus::ok) {
            session.plan.warn(fmt::format("frame {} is left out: {}", frame.index, frame.message));
            continue;
        }
        surveys.push_back(surveyor.look(frame));
        Preview preview;
        Snapshot& snapshot = preview.snapshot;
        snapshot.frame = frame.index;
        snapshot.time = frame.time;
        snapshot.box = {.origin = {-0.5, -0.5},
                        .length = {static_cast<double>(frame.image.width()),
                                   static_cast<double>(frame.image.height())}};
        snapshot.position = surveys.back().found.position;
        preview.abs_q4 = analysis::abs_q4(snapshot, tracker.info().diameter, {});
        preview.frame = std::move(frame);
        previews.push_back(std::move(preview));
    }
    return surveys;
}

Summary TuneCommand::work(Session& session) {
    if (!session.common.explain) require_output(session, output_);
    tracking_.threads = session.threads;
    const pipelines::Film film = pipelines::open_film(session, film_, tracking_);
    tracking_.visible = film.visible;
    const tracking::Tracker tracker(*film.frames, tracking_, session.plan);
    if (session.common.explain) return explanation(session.plan);
    if (!tracker.is_calibrated()) {
        throw InputError(
            {.problem = fmt::format("nothing to tune on in '{}'", session.inputs.front().string()),
             .actual = session.plan.warnings().empty() ? "no spheres were found"
                                                       : session.plan.warnings().back(),
             .expected = "a frame with spheres",
             .suggestion = "try --diameter and --polarity"});
    }
    const auto overwrite = session.overwrite;
    io::OutputFile html(output_, overwrite);
    std::optional<FiguresFolder> figures;
    if (report_.figures) figures.emplace(figures_folder(output_), overwrite);

    Results seen = run_of(session, tracker.info(), "frames");
    const std::vector<Survey> surveys = look(session, *film.frames, tracker, seen.previews);
    const pipelines::Tuning tuning{tracker.model(), tracking_, surveys};
    seen.frames = static_cast<std::int64_t>(surveys.size());
    seen.particles_mean = tuning.particles_mean();
    Results left = run_of(session, tracker.info(), "residual: image − model");
    left.frames = seen.frames;
    left.particles_mean = seen.particles_mean;
    left.previews = seen.previews;
    for (std::size_t i = 0; i < surveys.size(); ++i) {
        left.previews[i].frame.image = surveys[i].residual;
        // Discs would cover it.
        left.previews[i].snapshot.position.clear();
        left.previews[i].abs_q4.clear();
    }

    const auto settings = pipelines::suggested_settings(tuning, session);
    const std::string command_line = pipelines::command_line_of(settings, session);
    report::ReportOptions options = report_;
    options.threads = session.threads;
    options.observables = false;
    if (options.title.empty()) options.title = "Settings of the tracker";
    report::write_report({std::move(seen), std::move(left)}, options, html.temporary(),
                         figures_folder(output_), session.plan,
                         pipelines::tuning_report(tuning, settings, command_line));
    write_file(settings_file(output_), pipelines::toml_of(settings), overwrite);
    html.commit();
    session.outputs.emplace_back(output_);
    session.outputs.push_back(settings_file(output_));
    if (figures) {
        figures->keep();
        session.outputs.push_back(figures->path());
    }

    Summary summary;
    summary.text = fmt::format(
        "{}: {} looked at, {:.1f} spheres a frame, residual {:.4f} of the contrast\n"
        "  settings   {}\n  try        {}\n",
        output_, counted(static_cast<std::int64_t>(surveys.size()), "frame"),
        tuning.particles_mean(), tuning.residual_rms(), settings_file(output_).string(),
        command_line);
    summary.facts["frames"] = surveys.size();
    summary.facts["particles_mean"] = tuning.particles_mean();
    summary.facts["residual_rms"] = tuning.residual_rms();
    summary.facts["diameter_px"] = tracker.model().disc.diameter;
    summary.facts["edge_width_px"] = tracker.model().disc.edge_width;
    summary.facts["command_line"] = command_line;
    summary.facts["settings"] = nlohmann::ordered_json::object();
    for (const auto& [name, value] : settings) summary.facts["settings"][name] = value;
    return summary;
}

}  // namespace grainfield::app
