#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/option_table.h"

namespace grainfield::pipelines {

using Configuration = std::vector<std::pair<std::string, std::string>>;

/// Every option of the tables and its present value as text, under "section.name" or, in the table
/// without a section, "name"; those named in `left_out` are not among them.
Configuration recorded_options(const std::vector<OptionTable>& tables,
                               const std::vector<std::string_view>& left_out = {});

}  // namespace grainfield::pipelines
