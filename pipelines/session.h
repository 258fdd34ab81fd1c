#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/results.h"
#include "core/run_plan.h"
#include "pipelines/common_options.h"

namespace grainfield::pipelines {

/// One job: what it was asked for and what it gathers on the way.
struct Session {
    std::string command;
    CommonOptions common;
    std::vector<std::filesystem::path> inputs;
    std::vector<std::pair<std::string, std::string>> configuration;
    RunPlan plan;
    std::vector<std::filesystem::path> outputs;
    std::chrono::steady_clock::time_point start = std::chrono::steady_clock::now();

    int threads() const;
    double seconds() const;
    /// How this run came to be, with the inputs and what was skipped so far.
    RunRecord record() const;
};

/// "1 frame", "2 frames".
std::string counted(std::int64_t count, const std::string& noun);

}  // namespace grainfield::pipelines
