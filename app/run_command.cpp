#include "app/run_command.h"

#include <chrono>
#include <utility>

#include <fmt/format.h>

#include "app/bias_summary.h"
#include "app/config_file.h"
#include "core/support/output_file.h"
#include "core/support/progress.h"
#include "report/page/cards.h"

namespace grainfield::app {

namespace {

constexpr const char* options_file = "run.toml";

std::string words(const pipelines::RunJobResult& result, const pipelines::TrackJobOptions& options,
                  const Session& session) {
    std::string text;
    if (result.results) {
        const TrajectoryInfo& info = result.results->source;
        const auto source = options.film.fps  ? pipelines::RateSource::given
                            : info.frame_rate ? pipelines::RateSource::file
                                              : pipelines::RateSource::unknown;
        text += report::verdict(*result.results, std::nullopt) + "\n";
        text += pipelines::units_in_words(info, source, result.lab, session.plan);
        if (result.bias) text += fmt::format("  bias       positions {}\n", in_words(*result.bias));
    }
    for (const pipelines::RunStage& stage : result.stages) {
        text += fmt::format("  {:<10} {}{}\n", stage.name, stage.file.string(),
                            stage.is_kept ? " (kept)" : "");
    }
    return text;
}

}  // namespace

std::string RunCommand::purpose() const {
    return "film to report in one step: track, analyze, report, overlay";
}

Command::Inputs RunCommand::inputs() const {
    return {.placeholder = "VIDEO|IMAGE...",
            .meaning =
                "videos, images (PNG, TIFF, JPEG, BMP, PGM), a folder or a quoted pattern of "
                "them: one film in natural order",
            .count = Count::many};
}

std::vector<OptionTable> RunCommand::options() {
    OptionTable own("");
    own.text("output", folder_, "folder for all outputs; by default NAME-results after the film");
    own.affects(Effect::call);
    own.flag("overlay", job_.overlay, "also a video of the film with what was found");
    own.text("title", job_.report.title, "title of the report; by default the label");
    own.text("label", job_.analyze.label, "name in plots; by default the name of the film");
    own.flag("figures", job_.report.figures,
             "write every plot as SVG, PDF and CSV beside the page");
    describe(job_.track.film, own);
    pipelines::describe(job_.track.lab, own);
    own.text("camera", job_.track.camera,
             "camera file of calibrate-camera: positions are corrected for lens and tilt");
    own.integer("previews", job_.track.previews, "-", {0, 1000}, "frames that the report shows");
    own.flag("resume", job_.resume, "go on with what the folder holds; run does so without it too");
    own.affects(Effect::call);
    own.number("checkpoint-every", checkpoint_every_, "min", {0, 1e6}, "time between checkpoints");
    own.affects(Effect::work);
    tables_ = {own};
    for (OptionTable& table : tracking::describe(job_.track.tracking)) {
        tables_.push_back(std::move(table));
    }
    for (OptionTable& table : analysis::describe(job_.analyze.analysis)) {
        tables_.push_back(std::move(table));
    }
    return tables_;
}

void RunCommand::make_room_for(const GivenText& given) {
    pipelines::make_room_for(job_.track.lab, [&](const std::string& option) {
        const std::string text = given("", option);
        return !text.empty() && text != automatic;
    });
}

std::vector<std::string> RunCommand::usual() const {
    return {"output", "fps",  "sphere-diameter", "disc-diameter", "polarity", "frames",
            "region", "mask", "background",      "height"};
}

Summary RunCommand::run(Session& session) {
    pipelines::RunJobOptions job = job_;
    job.folder = folder_.empty() ? pipelines::default_folder(session.inputs).string() : folder_;
    require_folder_name(job.folder.string(), "the name of a folder");
    // Tracks that are kept say the same, or the run is refused.
    job.report.sphere_mm = job.track.lab.sphere_mm;
    job.analyze.adjustment.acceleration = job.track.lab.acceleration();
    job.track.resume.every = std::chrono::duration<double>(60 * checkpoint_every_);
    if (session.common.explain) {
        pipelines::plan_run(job, session);
        return explanation(session.plan);
    }
    const pipelines::RunJobResult result = pipelines::run_film(job, session);
    const auto written = job.folder / options_file;
    write_file(written,
               config_text(tables_, fmt::format("Options of a run, for the next one:\n"
                                                "  grainfield run FILM... -c {}\n"
                                                "A line that begins with # is the default.",
                                                written.string())),
               Overwrite::force);
    session.outputs.push_back(written);
    Summary summary{
        .text = words(result, job.track, session), .facts = {}, .signal = result.signal};
    summary.text += fmt::format("  {:<10} {}\n", "options", written.string());
    summary.facts["folder"] = job.folder.string();
    summary.facts["stages"] = nlohmann::ordered_json::array();
    for (const pipelines::RunStage& stage : result.stages) {
        summary.facts["stages"].push_back(
            {{"stage", stage.name}, {"file", stage.file.string()}, {"kept", stage.is_kept}});
    }
    if (result.results) {
        summary.facts["frames"] = result.results->frames;
        summary.facts["particles_mean"] = result.results->particles_mean;
        summary.facts["bias"] = result.bias ? bias_facts(*result.bias) : nlohmann::ordered_json();
    }
    return summary;
}

}  // namespace grainfield::app
