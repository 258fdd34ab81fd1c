#include "app/command.h"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/version.h"

namespace grainfield::app {

using nlohmann::ordered_json;

ordered_json json_summary(const Session& session, const Summary& summary) {
    ordered_json object;
    object["command"] = session.command;
    object["version"] = kVersion;
    object["seed"] = session.seed;
    object["threads"] = session.threads;
    object["seconds"] = session.seconds();
    object["skipped"] = ordered_json::array();
    for (const PlannedStage& stage : session.plan.skipped()) {
        object["skipped"].push_back(
            {{"stage", stage.stage}, {"reason", stage.reason}, {"saved", stage.saved}});
    }
    object["warnings"] = ordered_json::array();
    for (const Warning& warning : session.plan.warnings()) {
        object["warnings"].push_back(warning.text);
    }
    object["outputs"] = ordered_json::array();
    for (const auto& output : session.outputs) object["outputs"].push_back(output.string());
    for (const auto& [key, value] : summary.facts.items()) object[key] = value;
    return object;
}

Summary explanation(const RunPlan& plan) {
    Summary summary;
    summary.text = plan.text();
    summary.facts["plan"] = ordered_json::array();
    for (const PlannedStage& stage : plan.stages()) {
        summary.facts["plan"].push_back({{"stage", stage.stage},
                                         {"runs", stage.runs},
                                         {"reason", stage.reason},
                                         {"saved", stage.saved}});
    }
    return summary;
}

void require_output(const Session& session, const std::string& output) {
    if (output.empty()) {
        throw OptionError({.problem = fmt::format("'{}' needs an output", session.command),
                           .actual = {},
                           .expected = "-o FILE",
                           .suggestion = {}});
    }
    for (const auto& input : session.inputs) {
        std::error_code error;
        if (std::filesystem::equivalent(input, output, error) && !error) {
            throw OptionError({.problem = fmt::format("output '{}' is also an input", output),
                               .actual = {},
                               .expected = "another file",
                               .suggestion = "choose another name for -o"});
        }
    }
}

void require_hdf5_name(const std::string& output) {
    const std::string extension = std::filesystem::path(output).extension().string();
    if (extension == ".h5" || extension == ".hdf5") return;
    throw OptionError(
        {.problem = fmt::format("output '{}' would be an HDF5 file under another name", output),
         .actual = {},
         .expected = "a name that ends in .h5 or .hdf5",
         .suggestion =
             fmt::format("for example -o {}",
                         std::filesystem::path(output).replace_extension(".h5").string())});
}

}  // namespace grainfield::app
