#include "app/command.h"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

#include "core/errors.h"
#include "core/interrupt.h"
#include "core/parallel.h"
#include "core/version.h"
#include "io/input_record.h"

namespace grainfield::app {

using nlohmann::ordered_json;

namespace {

/// An interrupted run ends at once: reading a long video again for its checksum can wait.
RunRecord::Input input_of(const std::filesystem::path& path) {
    if (caught_signal() == 0) return io::describe_input(path);
    std::error_code unknown;
    const auto bytes = std::filesystem::file_size(path, unknown);
    return {path.string(), unknown ? 0 : bytes, "not computed, the run was interrupted"};
}

}  // namespace

int Session::threads() const {
    return thread_count(common.threads);
}

double Session::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

RunRecord Session::record() const {
    RunRecord record;
    record.command = command;
    record.version = kVersion;
    record.seed = static_cast<std::uint64_t>(common.seed);
    record.threads = threads();
    record.seconds = seconds();
    record.configuration = configuration;
    for (const auto& input : inputs) record.inputs.push_back(input_of(input));
    for (const PlannedStage& stage : plan.skipped()) {
        record.skipped.push_back(stage.stage + ": " + stage.reason);
    }
    record.warnings = plan.warnings();
    return record;
}

ordered_json json_summary(const Session& session, const Summary& summary) {
    ordered_json object;
    object["command"] = session.command;
    object["version"] = kVersion;
    object["seed"] = session.common.seed;
    object["threads"] = session.threads();
    object["seconds"] = session.seconds();
    object["skipped"] = ordered_json::array();
    for (const PlannedStage& stage : session.plan.skipped()) {
        object["skipped"].push_back(
            {{"stage", stage.stage}, {"reason", stage.reason}, {"saved", stage.saved}});
    }
    object["warnings"] = session.plan.warnings();
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

}  // namespace grainfield::app
