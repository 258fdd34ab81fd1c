#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "core/results.h"
#include "core/run_plan.h"

namespace grainfield::report {

/// Warnings of all runs as HTML; empty if there are none. With several runs each entry names its
/// run.
std::string warnings_html(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                          const RunPlan& plan);

/// How many lines they have there, those that are folded under another not counted.
std::size_t count_warnings(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                           const RunPlan& plan);

/// What was skipped and why, likewise.
std::string skipped_html(const std::vector<Results>& runs, const std::vector<std::string>& labels,
                         const RunPlan& plan);

/// How each run came to be, as HTML, from the first source on (images or a video, tracked; a
/// simulation) to the results: version, command, seed, threads, inputs with size and checksum, and
/// the whole configuration in a block to unfold. It holds no date.
std::string records_html(const std::vector<Results>& runs, const std::vector<std::string>& labels);

}  // namespace grainfield::report
