#pragma once

#include <filesystem>
#include <string>

#include "core/job_size.h"
#include "core/run_plan.h"

namespace grainfield::pipelines {

/// What to do with a job that is too large for the machine.
enum class SizeCheck { refuse, insist };

/// Memory that this process can still have [B]: the least of what the system has available
/// (MemAvailable), what the limits of the control groups above it leave (versions 1 and 2, caches
/// that can be dropped counted as free) and the limits of the process (`ulimit -v`, `-d`).
/// Infinite where nothing says. `root` stands before /proc and /sys.
double available_memory(const std::filesystem::path& root = "/");

/// The longest job that is begun without being insisted on [s]: a year.
constexpr double longest_job = 365.0 * 24 * 3600;

/// Says size and room in the plan. Throws OptionError with both numbers and `remedy` if the job
/// needs more than `available` bytes or longer than `longest_job`, unless it is insisted on: then
/// warns.
void require_room(const JobSize& size, double available, const std::string& remedy, SizeCheck check,
                  RunPlan& plan);

}  // namespace grainfield::pipelines
