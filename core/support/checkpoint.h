#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace grainfield {

/// All that a long run needs to go on bit-identically. Simulators and the tracker make and take it;
/// files are
/// io/h5/checkpoint_file.h.
struct Checkpoint {
    std::string kind;  ///< "md", "field", "track"

    /// The physics options, name → text; a run with others is refused and the difference shown.
    std::vector<std::pair<std::string, std::string>> configuration;

    std::map<std::string, std::vector<double>> reals;  ///< every bit is kept, NaN included
    std::map<std::string, std::vector<std::int64_t>> integers;
    std::map<std::string, std::vector<std::string>> texts;  ///< UTF-8

    friend bool operator==(const Checkpoint&, const Checkpoint&) = default;
};

}  // namespace grainfield
