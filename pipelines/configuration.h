#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/option_table.h"

namespace grainfield::pipelines {

using Configuration = std::vector<std::pair<std::string, std::string>>;

/// Every option of the tables that the result depends on (Effect::result) and its present value as
/// text, under "section.name" or, in the table without a section, "name".
Configuration physics_of(const std::vector<OptionTable>& tables);

/// Puts the present values of these options in place of those that the configuration has.
void update(Configuration& configuration, const std::vector<OptionTable>& tables);

}  // namespace grainfield::pipelines
