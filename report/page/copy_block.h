#pragma once

#include <string>

namespace grainfield::report {

/// Text to be copied, such as the settings of a run.
struct CopyBlock {
    std::string title;
    std::string text;
    std::string note{};  ///< below it; may be empty
};

}  // namespace grainfield::report
