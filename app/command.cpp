#include "app/command.h"

#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "app/output_name.h"
#include "core/errors.h"
#include "core/version.h"
#include "pipelines/run/run_job.h"

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

namespace {

// Of files the stem of the first one, of pictures what their names share.
std::string film_name(const std::vector<std::filesystem::path>& inputs) {
    const std::filesystem::path& first = inputs.front();
    std::error_code unreachable;
    const bool is_alone = inputs.size() == 1 &&
                          !std::filesystem::is_directory(first, unreachable) &&
                          first.string().find_first_of("*?[") == std::string::npos;
    if (is_alone || first.extension() == ".h5") return first.stem().string();
    try {
        const std::string folder = pipelines::default_folder(inputs).string();
        return folder.substr(0, folder.size() - std::string_view("-results").size());
    } catch (const InputError&) {
        return "film";  // what is wrong with them is said when they are opened
    }
}

}  // namespace

std::string named_after(const std::vector<std::filesystem::path>& inputs,
                        const std::string& ending) {
    if (inputs.empty()) return ending.substr(1);
    std::string name = film_name(inputs);
    for (const std::string_view before : {"-tracks", "-results", "-linked"}) {
        if (name.size() > before.size() && name.ends_with(before)) {
            name.resize(name.size() - before.size());
        }
    }
    return name + ending;
}

std::string mean_text(double mean) {
    const bool is_whole = std::abs(mean - std::round(mean)) < 0.05;
    return is_whole ? fmt::format("{:.0f}", mean) : fmt::format("{:.1f}", mean);
}

bool is_standard_output(const std::string& output) {
    return output == "-";
}

namespace {

constexpr const char* can_be_printed =
    "what can be: 'export' (CSV, of curves JSON), 'critical' (JSON), 'calibrate-camera' (TOML), "
    "'compare --figure' (SVG)";

// `what` cannot be on standard output.
void refuse_standard_output(const std::string& what, const std::string& expected) {
    throw OptionError({.problem = fmt::format("{} cannot go to standard output ('-')", what),
                       .actual = {},
                       .expected = expected,
                       .suggestion = can_be_printed});
}

}  // namespace

void require_html_name(const std::string& output) {
    const std::filesystem::path name = output;
    if (name.extension() == ".html" || name.extension() == ".htm") return;
    if (is_standard_output(output)) refuse_standard_output("a page", "a name that ends in .html");
    throw OptionError(
        {.problem = fmt::format("output '{}' would be a page under another name", output),
         .actual = {},
         .expected = "a name that ends in .html",
         .suggestion =
             fmt::format("for example -o {}",
                         std::filesystem::path(output).replace_extension(".html").string())});
}

void require_folder_name(const std::string& output, const std::string& expected) {
    if (is_standard_output(output)) refuse_standard_output("a folder", expected);
    if (is_folder_name(output)) return;
    throw OptionError({.problem = fmt::format("output '{}' would be a folder", output),
                       .actual = {},
                       .expected = expected,
                       .suggestion = {}});
}

void require_hdf5_name(const std::string& output) {
    const std::string extension = std::filesystem::path(output).extension().string();
    if (extension == ".h5" || extension == ".hdf5") return;
    if (is_standard_output(output)) {
        refuse_standard_output("an HDF5 file",
                               "a name that ends in .h5; then 'grainfield export NAME.h5 -o -'");
    }
    throw OptionError(
        {.problem = fmt::format("output '{}' would be an HDF5 file under another name", output),
         .actual = {},
         .expected = "a name that ends in .h5 or .hdf5",
         .suggestion =
             fmt::format("for example -o {}",
                         std::filesystem::path(output).replace_extension(".h5").string())});
}

}  // namespace grainfield::app
