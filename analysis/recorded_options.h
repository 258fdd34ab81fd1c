#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/option_table.h"

namespace grainfield::analysis {

/// The options of a table as they are recorded with a result: names and present values.
std::vector<std::pair<std::string, OptionValue>> recorded(const OptionTable& table);

}  // namespace grainfield::analysis
