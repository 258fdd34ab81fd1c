#include "pipelines/size_check.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>

#include <fmt/format.h>
#include <sys/resource.h>

#include "core/errors.h"

namespace grainfield::pipelines {

namespace {

namespace fs = std::filesystem;

constexpr double unlimited = std::numeric_limits<double>::infinity();

// The number in a file that holds one; nothing for "max" or no file.
std::optional<double> number_in(const fs::path& file) {
    std::ifstream in(file);
    double value = 0;
    if (!(in >> value)) return std::nullopt;
    return value;
}

// The number behind `key` in a file of keys and numbers.
std::optional<double> number_of(const fs::path& file, const std::string& key) {
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
        std::istringstream words(line);
        std::string word;
        double value = 0;
        if (words >> word && word == key && words >> value) return value;
    }
    return std::nullopt;
}

/// How the files of a version of control groups are called.
struct GroupFiles {
    const char* limit;
    const char* usage;
    const char* droppable;  ///< in memory.stat
};

double left_in(const fs::path& group, const GroupFiles& files) {
    const auto limit = number_in(group / files.limit);
    const auto usage = number_in(group / files.usage);
    if (!limit || !usage) return unlimited;
    const double droppable = number_of(group / "memory.stat", files.droppable).value_or(0);
    return std::max(*limit - *usage + droppable, 0.0);
}

// The least that the group of this process and those above it leave.
double left_in_groups(const fs::path& mount, const fs::path& group, const GroupFiles& files) {
    double least = left_in(mount, files);
    fs::path path = mount;
    for (const fs::path& part : group.relative_path()) {
        path /= part;
        least = std::min(least, left_in(path, files));
    }
    return least;
}

double left_by_control_groups(const fs::path& root) {
    constexpr GroupFiles second{"memory.max", "memory.current", "inactive_file"};
    constexpr GroupFiles first{"memory.limit_in_bytes", "memory.usage_in_bytes",
                               "total_inactive_file"};
    const fs::path mount = root / "sys/fs/cgroup";
    double least = unlimited;
    std::ifstream groups(root / "proc/self/cgroup");
    for (std::string line; std::getline(groups, line);) {
        // "hierarchy:controllers:path"
        const auto colon = line.find(':');
        const auto next = line.find(':', colon == std::string::npos ? colon : colon + 1);
        if (next == std::string::npos) continue;
        const std::string controllers =
            fmt::format(",{},", line.substr(colon + 1, next - colon - 1));
        const fs::path path = line.substr(next + 1);
        if (controllers == ",,") {
            least = std::min(least, left_in_groups(mount, path, second));
        } else if (controllers.find(",memory,") != std::string::npos) {
            least = std::min(least, left_in_groups(mount / "memory", path, first));
        }
    }
    return least;
}

double left_by_process_limits(const fs::path& root) {
    double least = unlimited;
    const auto left = [&](auto resource, const char* used) {
        rlimit limit{};
        if (::getrlimit(resource, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
        const double kilobytes = number_of(root / "proc/self/status", used).value_or(0);
        least =
            std::min(least, std::max(static_cast<double>(limit.rlim_cur) - 1024 * kilobytes, 0.0));
    };
    left(RLIMIT_AS, "VmSize:");
    left(RLIMIT_DATA, "VmData:");
    return least;
}

std::string memory_text(double bytes) {
    return bytes < 1e9 ? fmt::format("{:.0f} MB", bytes / 1e6)
                       : fmt::format("{:.3g} GB", bytes / 1e9);
}

std::string time_text(double seconds) {
    constexpr double day = 24 * 3600;
    if (seconds < 90) return fmt::format("{:.0f} s", std::max(seconds, 1.0));
    if (seconds < 5400) return fmt::format("{:.0f} min", seconds / 60);
    if (seconds < 2 * day) return fmt::format("{:.0f} h", seconds / 3600);
    if (seconds < 2 * longest_job) return fmt::format("{:.0f} days", seconds / day);
    return fmt::format("{:.3g} years", seconds / longest_job);
}

}  // namespace

double available_memory(const fs::path& root) {
    const auto kilobytes = number_of(root / "proc/meminfo", "MemAvailable:");
    const double system = kilobytes ? 1024 * *kilobytes : unlimited;
    return std::min({system, left_by_control_groups(root), left_by_process_limits(root)});
}

void require_room(const JobSize& size, double available, const std::string& remedy, SizeCheck check,
                  RunPlan& plan) {
    const std::string needed =
        fmt::format("about {} of memory and {}", memory_text(size.bytes), time_text(size.seconds));
    const std::string there =
        fmt::format("at most {}, which are free, and a year", memory_text(available));
    const bool fits = size.bytes <= available && size.seconds <= longest_job;
    if (fits) {
        plan.run("size", fmt::format("{}; {} are free", needed, memory_text(available)));
        return;
    }
    if (check == SizeCheck::insist) {
        plan.warn(fmt::format("the size is insisted on: {}; expected {}", needed, there));
        return;
    }
    throw OptionError(
        {.problem = "a run of this size is too large for this machine",
         .actual = needed,
         .expected = there,
         .suggestion = fmt::format("{}, or insist with option 'force-size'", remedy)});
}

}  // namespace grainfield::pipelines
