#include "pipelines/job.h"

#include <fmt/format.h>

#include "core/version.h"
#include "io/input_record.h"

namespace grainfield::pipelines {

double Job::seconds() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

RunRecord Job::record() const {
    RunRecord record;
    record.command = command;
    record.version = kVersion;
    record.seed = seed;
    record.threads = threads;
    record.seconds = seconds();
    record.configuration = configuration;
    for (const auto& input : inputs) record.inputs.push_back(io::describe_input(input));
    for (const PlannedStage& stage : plan.skipped()) {
        record.skipped.push_back(stage.stage + ": " + stage.reason);
    }
    record.warnings = plan.warnings();
    return record;
}

std::string counted(std::int64_t count, const std::string& noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

}  // namespace grainfield::pipelines
