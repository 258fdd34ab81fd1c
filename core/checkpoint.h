#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace grainfield {

/// All that a long run needs to go on bit-identically.
struct Checkpoint {
    std::string kind;  ///< "md", "field"
    /// Physics options; a run with others is refused, the difference shown.
    std::vector<std::pair<std::string, std::string>> configuration;
    std::map<std::string, std::vector<double>> reals;
    std::map<std::string, std::vector<std::int64_t>> integers;
};

}  // namespace grainfield
