#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/results.h"
#include "core/run_plan.h"
#include "core/support/output_file.h"
#include "core/support/progress.h"
#include "pipelines/size_check.h"

namespace grainfield::pipelines {

/// One job of a pipeline: what it is given, what it may use, and what it gathers on the way.
struct Job {
    std::string command;                        ///< as recorded in the outputs: "track"
    std::vector<std::filesystem::path> inputs;  ///< recorded with size and checksum
    /// All options, name → text, as recorded in the outputs.
    std::vector<std::pair<std::string, std::string>> configuration;
    /// Those of them that the outputs do not depend on (Effect::work), by name.
    std::vector<std::string> indifferent;

    int threads = 1;
    std::uint64_t seed = 1;  ///< of all random streams
    Verbosity verbosity = Verbosity::quiet;
    Overwrite overwrite = Overwrite::refuse;   ///< outputs that exist
    SizeCheck size_check = SizeCheck::refuse;  ///< jobs too large for the machine

    RunPlan plan;                                ///< stages and warnings so far
    std::vector<std::filesystem::path> outputs;  ///< complete ones
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();

    double seconds() const;  ///< wall time since `start` [s]
    /// How this run came to be, with the inputs and what was skipped so far.
    RunRecord record() const;
};

/// "1 frame", "2 frames".
std::string counted(std::int64_t count, const std::string& noun);

}  // namespace grainfield::pipelines
