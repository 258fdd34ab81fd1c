#pragma once

#include <string>
#include <vector>

#include "core/results.h"
#include "core/run_plan.h"

namespace grainfield::report {

/// Warnings of all runs and what was skipped and why, as HTML; empty if there is nothing to say.
/// With several runs each entry names its run.
std::string remarks_html(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                         const RunPlan& plan);

/// How each run came to be, as HTML: version, command, seed, threads, inputs with size and
/// checksum, and the whole configuration in a block to unfold. It holds no date.
std::string records_html(const std::vector<Results>& runs, const std::vector<std::string>& labels);

}  // namespace grainfield::report
