#include "app/link_command.h"

#include <fmt/format.h>

#include "pipelines/interrupt_deadline.h"

namespace grainfield::app {

namespace {

using nlohmann::ordered_json;
using pipelines::LinkJobResult;

std::string words(const Session& session, const LinkJobResult& result) {
    std::string text = fmt::format(
        "{}: {} of {}, {} particles per frame\n"
        "  tracks     {} begun, {} ended; RMS step {:.3f} px; {} across missing frames\n",
        session.outputs.front().string(), counted(result.parts, "part"),
        counted(result.frames, "frame"), mean_text(result.particles_mean), result.links.started,
        result.links.ended, result.step_rms, counted(result.links.bridged, "step"));
    if (result.layers.spheres > 0) {
        text += fmt::format("  layers     {}\n", tracking::in_words(result.layers));
    }
    return text + fmt::format("  time       {}\n", format_duration(session.seconds()));
}

ordered_json facts(const LinkJobResult& result) {
    ordered_json facts;
    facts["parts"] = result.parts;
    facts["frames"] = result.frames;
    facts["particles_mean"] = result.particles_mean;
    facts["tracks"] = result.links.started;
    facts["step_rms_px"] = result.step_rms;
    facts["layers"] = nullptr;
    if (result.layers.spheres > 0) {
        facts["layers"] = {{"labelled", result.layers.labelled},
                           {"bottom", result.layers.labelled - result.layers.top},
                           {"top", result.layers.top},
                           {"unknown", result.layers.spheres - result.layers.labelled},
                           {"positions", result.layers.spheres},
                           {"contradictory", result.layers.contradictory}};
    }
    return facts;
}

}  // namespace

std::string LinkCommand::purpose() const {
    return "join parts of one film that were tracked apart, and follow the spheres";
}

Command::Inputs LinkCommand::inputs() const {
    return {.placeholder = "PART.h5...",
            .meaning = "all parts of a film, from 'track --no-link', in any order",
            .count = Count::many};
}

std::vector<OptionTable> LinkCommand::options() {
    OptionTable own("");
    own.text("output", output_, "trajectory file to write (H5MD)");
    own.flag("allow-gaps", job_.allow_gaps, "frames that no part has count as missing");
    own.flag("allow-overlaps", job_.allow_overlaps,
             "frames that two parts have are taken from the one that begins first");
    return {own, tracking::describe(job_.link)};
}

std::vector<std::string> LinkCommand::usual() const {
    return {"output",    "allow-gaps",     "allow-overlaps", "search-range", "memory",
            "predictor", "minimum-length", "threads",        "force",        "json"};
}

std::string LinkCommand::default_output(const std::vector<std::filesystem::path>& inputs) const {
    return named_after(inputs, "-linked.h5");
}

Summary LinkCommand::run(Session& session) {
    return pipelines::run_or_discard("linking", output_, [&]() -> Summary {
        require_output(session, output_);
        require_hdf5_name(output_);
        job_.output = output_;
        if (session.common.explain) {
            pipelines::plan_linking(job_, session);
            return explanation(session.plan);
        }
        const LinkJobResult result = pipelines::link_parts(job_, session);
        return {.text = words(session, result), .facts = facts(result), .signal = 0};
    });
}

}  // namespace grainfield::app
