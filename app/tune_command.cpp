#include "app/tune_command.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "app/option_set.h"
#include "app/track_command.h"
#include "core/errors.h"
#include "io/joined_films.h"
#include "pipelines/interrupt_deadline.h"

namespace grainfield::app {

namespace {

/// One word of a POSIX shell.
std::string shell_word(const std::string& text) {
    std::string escaped;
    for (const char c : text) {
        if (c == '\'') {
            escaped += "'\\''";
        } else {
            escaped += c;
        }
    }
    return fmt::format("'{}'", escaped);
}

/// A text as TOML has it, without its marks; all else as it is.
std::string plain_text(const std::string& toml) {
    std::string text;
    for (std::size_t i = 1; i + 1 < toml.size(); ++i) {
        if (toml[i] == '\\' && i + 2 < toml.size()) ++i;
        text += toml[i];
    }
    return text;
}

/// The folder, where they are all that is in it, as a shell makes them of a pattern.
std::vector<std::filesystem::path> in_short(const std::vector<std::filesystem::path>& inputs) {
    constexpr std::size_t few = 3;
    if (inputs.size() <= few) return inputs;
    std::filesystem::path folder = inputs.front().parent_path();
    if (folder.empty()) folder = ".";
    try {
        if (std::ranges::equal(io::recording_files({folder}), inputs, {},
                               &std::filesystem::path::lexically_normal,
                               &std::filesystem::path::lexically_normal)) {
            return {folder};
        }
    } catch (const InputError&) {
        // Of several kinds.
        return inputs;
    }
    return inputs;
}

}  // namespace

std::string track_command_line(const std::vector<pipelines::Setting>& settings,
                               const std::vector<std::filesystem::path>& inputs) {
    TrackCommand track;
    const OptionSet options(track.name(), track.options());
    std::string text = "grainfield track";
    for (const auto& input : in_short(inputs)) {
        text += fmt::format(" {}", shell_word(input.string()));
    }
    text += " -o tracks.h5";
    for (const pipelines::Setting& setting : settings) {
        const OptionSet::Entry* entry = options.find(setting.section, setting.name);
        const std::string flag = entry == nullptr ? setting.name : entry->flag;
        if (setting.value == "true" || setting.value == "false") {
            text += (setting.value == "true" ? " --" : " --no-") + flag;
            continue;
        }
        const bool is_text = setting.value.starts_with('"');
        text += fmt::format(" --{} {}", flag,
                            is_text ? shell_word(plain_text(setting.value)) : setting.value);
    }
    return text;
}

std::string TuneCommand::purpose() const {
    return "preview what track finds with its settings, and suggest better ones";
}

Command::Inputs TuneCommand::inputs() const {
    return {.placeholder = "VIDEO|IMAGE...",
            .meaning = "videos, images, a folder or a pattern of them, as for track",
            .count = Count::many};
}

std::vector<OptionTable> TuneCommand::options() {
    OptionTable own("");
    own.text("output", output_, "HTML page to write; settings and figures go beside it");
    own.text("title", job_.report.title, "title of the page");
    own.flag("figures", job_.report.figures, "write every plot and table as SVG, PDF and CSV too");
    own.integer("samples", job_.samples, "frames", {1, 20}, "looked at, spread over the film");
    describe(job_.film, own);
    std::vector<OptionTable> tables{own};
    for (OptionTable& table : tracking::describe(job_.tracking)) tables.push_back(std::move(table));
    return tables;
}

std::vector<std::string> TuneCommand::usual() const {
    return {"output",     "samples",       "frames",   "region",  "mask",
            "background", "disc-diameter", "polarity", "profile", "meeting-edges"};
}

std::string TuneCommand::default_output(const std::vector<std::filesystem::path>& inputs) const {
    return named_after(inputs, "-tune.html");
}

Summary TuneCommand::run(Session& session) {
    return pipelines::run_or_discard("tuning", output_, [&] { return work(session); });
}

Summary TuneCommand::work(Session& session) {
    if (session.common.explain) {
        pipelines::plan_tuning(job_, session);
        return explanation(session.plan);
    }
    require_output(session, output_);
    require_html_name(output_);
    job_.output = output_;
    const std::vector<std::filesystem::path> typed = session.inputs;  // a folder becomes its files
    job_.in_words = [&](const std::vector<pipelines::Setting>& settings) {
        return track_command_line(settings, typed);
    };
    const pipelines::TuneJobResult result = pipelines::run_tuning(job_, session);
    Summary summary;
    if (result.settings.empty()) {
        summary.text = fmt::format(
            "{}: it is not clear what the spheres are; the page shows what was weighed, with "
            "settings to copy\n  weighed    {}\n",
            output_, tracking::in_words(result.weighed));
        summary.facts["frames"] = 0;
        summary.facts["settings"] = nlohmann::ordered_json::object();
        return summary;
    }
    const std::string command_line = job_.in_words(result.settings);

    summary.text = fmt::format(
        "{}: {} looked at, {} spheres a frame, residual {:.4f} of the contrast\n"
        "  settings   {}{}\n  try        {}\n",
        output_, counted(result.frames, "frame"), mean_text(result.particles_mean),
        result.residual_rms, result.settings_file.string(),
        result.advice.empty() ? "" : " (those that fit better, see the warning)", command_line);
    summary.facts["frames"] = result.frames;
    summary.facts["particles_mean"] = result.particles_mean;
    summary.facts["residual_rms"] = result.residual_rms;
    summary.facts["diameter_px"] = result.diameter;
    summary.facts["edge_width_px"] = result.edge_width;
    summary.facts["command_line"] = command_line;
    if (!result.advice.empty()) summary.facts["advice"] = result.advice;
    summary.facts["settings"] = nlohmann::ordered_json::object();
    for (const pipelines::Setting& setting : result.settings) {
        summary.facts["settings"][setting.section + "." + setting.name] = setting.value;
    }
    return summary;
}

}  // namespace grainfield::app
