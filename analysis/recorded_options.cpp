#include "analysis/recorded_options.h"

namespace grainfield::analysis {

std::vector<std::pair<std::string, OptionValue>> recorded(const OptionTable& table) {
    std::vector<std::pair<std::string, OptionValue>> values;
    for (const Option& option : table.rows()) values.emplace_back(option.name, option.get());
    return values;
}

}  // namespace grainfield::analysis
