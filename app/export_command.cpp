#include "app/export_command.h"

#include <system_error>

#include <fmt/format.h>

#include "app/output_name.h"
#include "app/standard_output.h"
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

std::string expected_name(bool has_points, bool has_curves) {
    if (!has_points) return "the name of a folder, into which each curve goes as NAME.csv";
    return has_curves ? "a name that ends in .csv or .xyz for the particles, else the name of a "
                        "folder for the curves"
                      : "a name that ends in .csv or .xyz";
}

Form form_for(const fs::path& input, io::FileKind kind, const fs::path& output) {
    const std::string extension = output.extension().string();
    const bool has_points = kind == io::FileKind::trajectory || kind == io::FileKind::points;
    const bool has_curves = kind == io::FileKind::results || kind == io::FileKind::trajectory;
    if (!has_points && !has_curves) {
        throw InputError({.problem = fmt::format("cannot export '{}'", input.string()),
                          .actual = "neither a trajectory, nor results, nor a table of points",
                          .expected = {},
                          .suggestion = fmt::format("see 'grainfield info {}'", input.string())});
    }
    std::error_code unreachable;
    const bool is_there = fs::is_directory(output, unreachable);
    if (has_points && !is_there && extension == ".csv") return Form::csv;
    if (has_points && !is_there && extension == ".xyz") return Form::xyz;
    if (has_curves && is_folder_name(output)) return Form::curves;
    throw OptionError(
        {.problem = fmt::format("cannot tell what form '{}' is to have", output.string()),
         .actual = {},
         .expected = expected_name(has_points, has_curves),
         .suggestion = has_curves
                           ? fmt::format("for a folder of this name give -o {}/", output.string())
                           : std::string()});
}

void require_form(Form named, Printed wanted, const std::string& output) {
    const bool fits = wanted == Printed::as_named ||
                      (wanted == Printed::csv && named == Form::csv) ||
                      (wanted == Printed::xyz && named == Form::xyz);
    if (fits) return;
    const char* const ending = wanted == Printed::csv ? ".csv" : ".xyz";
    throw OptionError({.problem = fmt::format("output '{}' is not of the format asked for", output),
                       .actual = {},
                       .expected = fmt::format("a name that ends in {}", ending),
                       .suggestion = "leave option 'format' out: the name says it"});
}

void require_no_format(Printed wanted) {
    if (wanted == Printed::as_named) return;
    throw OptionError({.problem = "results hold curves, not a table of spheres",
                       .actual = "option 'format' is given",
                       .expected = "no format: each curve is a CSV of its own",
                       .suggestion = "leave option 'format' out and give a folder"});
}

// "layer.csv" of layer.h5, "layer-results-curves" of results; other tables keep their name free.
std::string exported_name(const std::vector<fs::path>& inputs) {
    if (inputs.empty()) return {};
    const std::string name = inputs.front().stem().string();
    switch (io::identify(inputs.front())) {
        case io::FileKind::trajectory:
            return name + ".csv";
        case io::FileKind::results:
            return is_folder_name(name + "-curves") ? name + "-curves" : name + "-curves/";
        case io::FileKind::points:
            return name + ".xyz";
        default:
            return {};
    }
}

// Of what is known about a trajectory, only that frames of it are missing changes a table of it.
void warn_of_missing(const SnapshotSource& snapshots, RunPlan& plan) {
    const auto* file = dynamic_cast<const io::TrajectoryFile*>(&snapshots);
    if (file == nullptr) return;
    for (const Warning& warning : file->record().warnings) {
        if (warning.code == WarningCode::incomplete) plan.warn(warning);
    }
}

std::unique_ptr<SnapshotSource> open_to_export(const fs::path& input, RunPlan& plan) {
    auto snapshots = io::open_snapshots(input, std::nullopt, {});
    warn_of_missing(*snapshots, plan);
    return snapshots;
}

// {"sk": {"sk": {"k": [...], "s": [...]}, ...}, ...}
std::string curves_json(const Results& results) {
    nlohmann::ordered_json all = nlohmann::ordered_json::object();
    for (const ObservableResult& observable : results.observables) {
        for (const Curve& curve : observable.curves) {
            nlohmann::ordered_json& table = all[observable.name][curve.name];
            for (const Column& column : curve.columns) table[column.name] = column.values;
            for (const auto& [name, words] : curve.text_columns) table[name] = words;
        }
    }
    return all.dump() + "\n";
}

// Results as they are; of a trajectory, the tables that a simulation keeps beside it.
Results curves_of(const fs::path& input, RunPlan& plan) {
    if (io::identify(input) == io::FileKind::results) return io::read_results(input);
    const io::TrajectoryFile file(input);
    warn_of_missing(file, plan);
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
    own.text(
        "output", output_,
        "FILE.csv or FILE.xyz for trajectories, a folder for curves; - prints CSV, of curves JSON");
    own.choice("format", printed_,
               {{"auto", Printed::as_named}, {"csv", Printed::csv}, {"xyz", Printed::xyz}},
               "of particles; auto: as the name of the output says, CSV on standard output");
    own.flag("header", form_.header,
             "units, diameter, rate and box as comments in the CSV; else in FILE.csv.meta");
    own.choice("digits", form_.digits,
               {{"as-errors", io::Digits::as_errors}, {"all", io::Digits::all}},
               "of positions: to a tenth of their error, or all that a number has");
    own.text("overlay", overlay_output_,
             "FILE.mp4: the film with detections, trails and a colour key; in place of --output");
    own.text("film", film_,
             "of --overlay: the video, folder or pattern that was tracked; by default as recorded; "
             "none: on white");
    own.choice("colour", overlay_.colour,
               {{"q4", pipelines::OverlayColour::order},
                {"speed", pipelines::OverlayColour::speed},
                {"layer", pipelines::OverlayColour::layer},
                {"phase", pipelines::OverlayColour::phase}},
               "of --overlay: what the colours of the particles tell");
    own.integer("trail", overlay_.trail, "frames", {0, 10000},
                "of --overlay: length of the trails");
    own.number("overlay-fps", overlay_.fps, "1/s", {0.01, 1000},
               "of --overlay: rate of the video; auto: as filmed, 25 above 60");
    return {own};
}

std::string ExportCommand::default_output(const std::vector<std::filesystem::path>& inputs) const {
    if (!overlay_output_.empty()) return {};
    fs::path name = exported_name(inputs);
    if (printed_ == Printed::as_named || name.extension().empty()) return name.string();
    return name.replace_extension(printed_ == Printed::xyz ? ".xyz" : ".csv").string();
}

Summary ExportCommand::run(Session& session) {
    if (!overlay_output_.empty()) {
        return pipelines::run_or_discard("overlay", overlay_output_,
                                         [&] { return run_overlay(session); });
    }
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

// The table of a trajectory as CSV, curves as JSON.
Summary ExportCommand::print(Session& session) const {
    require_no_json_beside(session);
    const fs::path& input = session.inputs.front();
    const io::FileKind kind = io::identify(input);
    Summary summary;
    summary.is_table = true;
    if (kind == io::FileKind::results) {
        require_no_format(printed_);
        summary.text = curves_json(io::read_results(input));
        return summary;
    }
    const bool is_xyz = printed_ == Printed::xyz;
    const char* const name = is_xyz ? "table.xyz" : "table.csv";
    form_for(input, kind, name);
    const StandardOutputFile table(name);
    const auto snapshots = open_to_export(input, session.plan);
    if (is_xyz) {
        io::export_xyz(*snapshots, table.path(), Overwrite::refuse, form_.digits);
    } else {
        io::export_csv(*snapshots, table.path(), Overwrite::refuse, form_);
    }
    summary.text = table.text();
    return summary;
}

Summary ExportCommand::work(Session& session) const {
    if (is_standard_output(output_) && !session.common.explain) return print(session);
    require_output(session, output_);
    const auto overwrite = session.overwrite;
    const fs::path& input = session.inputs.front();
    const Form form = form_for(input, io::identify(input), output_);
    require_form(form, printed_, output_);
    session.plan.run("export", fmt::format("'{}' to '{}'", input.string(), output_));
    if (session.common.explain) return explanation(session.plan);

    Summary summary;
    if (form == Form::curves) {
        const Results results = curves_of(input, session.plan);
        io::export_curves(results, output_, overwrite);
        summary.text = fmt::format(
            "{}: curves of {}\n", output_,
            counted(static_cast<std::int64_t>(results.observables.size()), "observable"));
        summary.facts["observables"] = results.observables.size();
    } else {
        const auto snapshots = open_to_export(input, session.plan);
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
