#pragma once

#include <string>
#include <vector>

namespace grainfield::report {

/// Text to be copied, such as the settings of a run.
struct CopyBlock {
    std::string title;
    std::string text;
    std::string note{};  ///< below it; may be empty
};

/// Each with a button that copies its text; empty without blocks.
std::string blocks_html(const std::vector<CopyBlock>& blocks);

}  // namespace grainfield::report
