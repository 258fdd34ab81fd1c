#include "app/export_command.h"

#include <fmt/format.h>

#include "core/errors.h"
#include "core/support/output_file.h"
#include "io/file_kind.h"
#include "io/h5/results_file.h"
#include "io/h5/trajectory_file.h"
#include "io/open_snapshots.h"
#include "io/text/points_statement.h"
#include "io/video/colour_video.h"
#include "pipelines/interrupt_deadline.h"

namespace grainfield::app {

namespace {

namespace fs = std::filesystem;

enum class Form { csv, xyz, curves };

bool is_folder_name(const fs::path& output) {
    return output.extension().empty() || output.filename().empty();
}

Form form_for(const fs::path& input, io::FileKind kind, const fs::path& output) {
    const std::string extension = output.extension().string();
    const bool has_points = kind == io::FileKind::trajectory || kind == io::FileKind::points;
    if (has_points && extension == ".csv") return Form::csv;
    if (has_points && extension == ".xyz") return Form::xyz;
    const bool has_curves = kind == io::FileKind::results || kind == io::FileKind::trajectory;
    if (has_curves && is_folder_name(output)) return Form::curves;
    if (!has_points && kind != io::FileKind::results) {
        throw InputError({.problem = fmt::format("cannot export '{}'", input.string()),
                          .actual = "neither a trajectory, nor results, nor a table of points",
                          .expected = {},
                          .suggestion = fmt::format("see 'grainfield info {}'", input.string())});
    }
    throw OptionError(
        {.problem = fmt::format("cannot tell what form '{}' is to have", output.string()),
         .actual = {},
         .expected = has_points ? "a name that ends in .csv or .xyz" : "the name of a folder",
         .suggestion = {}});
}

// Results as they are; of a trajectory, the tables that a simulation keeps beside it.
Results curves_of(const fs::path& input) {
    if (io::identify(input) == io::FileKind::results) return io::read_results(input);
    const io::TrajectoryFile file(input);
    if (file.curves().empty()) {
        throw InputError({.problem = fmt::format("'{}' holds no curves", input.string()),
                          .actual = {},
                          .expected = {},
                          .suggestion = "give a name that ends in .csv or .xyz for its particles"});
    }
    Results results;
    ObservableResult series;
    series.name = "series";
    series.curves = file.curves();
    results.observables.push_back(std::move(series));
    return results;
}

}  // namespace

std::string ExportCommand::purpose() const {
    return "write a trajectory as CSV, XYZ or video, or curves as CSV";
}

Command::Inputs ExportCommand::inputs() const {
    return {.placeholder = "FILE",
            .meaning = "a trajectory, results or points file",
            .count = Count::one};
}

std::vector<OptionTable> ExportCommand::options() {
    OptionTable own("");
    own.text("output", output_, "FILE.csv or FILE.xyz for trajectories, a folder for curves");
    own.flag("header", form_.header,
             "units, diameter, rate and box as comments in the CSV; else in FILE.csv.meta");
    own.choice("digits", form_.digits,
               {{"as-errors", io::Digits::as_errors}, {"all", io::Digits::all}},
               "of positions: to a tenth of their error, or all that a number has");
    own.text("overlay", overlay_output_,
             "FILE.mp4: the film with detections, trails and |Q4| colours; in place of --output");
    own.text(
        "film", film_,
        "of --overlay: the video or folder of frames that was tracked; by default as recorded");
    own.integer("trail", overlay_.trail, "frames", {0, 10000},
                "of --overlay: length of the trails");
    own.number("overlay-fps", overlay_.fps, "1/s", {0.01, 1000},
               "of --overlay: rate of the video; auto: as filmed, 25 above 60");
    return {own};
}

Summary ExportCommand::run(Session& session) {
    if (!overlay_output_.empty()) return run_overlay(session);
    return pipelines::run_or_discard("export", output_, [&] { return work(session); });
}

Summary ExportCommand::run_overlay(Session& session) const {
    if (!output_.empty()) {
        throw OptionError({.problem = "--output and --overlay exclude each other",
                           .actual = fmt::format("'{}' and '{}'", output_, overlay_output_),
                           .expected = "one of them",
                           .suggestion = "run export twice"});
    }
    require_output(session, overlay_output_);
    if (!io::is_colour_video_name(overlay_output_)) {
        throw OptionError(
            {.problem = fmt::format("cannot tell what video '{}' is to be", overlay_output_),
             .actual = {},
             .expected = "a name that ends in .mp4, .mkv or .mov",
             .suggestion = {}});
    }
    pipelines::OverlayJobOptions job = overlay_;
    job.output = overlay_output_;
    job.film = film_;
    if (session.common.explain) {
        pipelines::plan_overlay(job, session);
        return explanation(session.plan);
    }
    const pipelines::OverlayJobResult result = pipelines::draw_overlay(job, session);
    Summary summary;
    summary.signal = result.signal;
    summary.text = fmt::format("{}: {}, {} x {} px, {:g} a second{}\n", overlay_output_,
                               counted(result.frames, "frame"), result.width, result.height,
                               result.fps, result.has_film ? "" : ", without the film");
    summary.facts["frames"] = result.frames;
    summary.facts["frame_rate"] = result.fps;
    return summary;
}

Summary ExportCommand::work(Session& session) const {
    require_output(session, output_);
    const auto overwrite = session.overwrite;
    const fs::path& input = session.inputs.front();
    const Form form = form_for(input, io::identify(input), output_);
    session.plan.run("export", fmt::format("'{}' to '{}'", input.string(), output_));
    if (session.common.explain) return explanation(session.plan);

    Summary summary;
    if (form == Form::curves) {
        const Results results = curves_of(input);
        io::export_curves(results, output_, overwrite);
        summary.text =
            fmt::format("{}: curves of {} observables\n", output_, results.observables.size());
        summary.facts["observables"] = results.observables.size();
    } else {
        const auto snapshots = io::open_snapshots(input, std::nullopt, {});
        if (form == Form::csv) io::export_csv(*snapshots, output_, overwrite, form_);
        if (form == Form::xyz) io::export_xyz(*snapshots, output_, overwrite, form_.digits);
        summary.text = fmt::format("{}: {}\n", output_, counted(snapshots->count(), "frame"));
        summary.facts["frames"] = snapshots->count();
    }
    session.outputs.push_back(output_);
    if (form == Form::csv && !form_.header) {
        session.outputs.push_back(io::statement_path(output_));
    }
    return summary;
}

}  // namespace grainfield::app
