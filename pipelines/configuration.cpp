#include "pipelines/configuration.h"

#include <algorithm>

namespace grainfield::pipelines {

namespace {

std::string full_name(const OptionTable& table, const Option& row) {
    return (table.section().empty() ? "" : table.section() + ".") + row.name;
}

}  // namespace

Configuration physics_of(const std::vector<OptionTable>& tables) {
    Configuration options;
    for (const OptionTable& table : tables) {
        for (const Option& row : table.rows()) {
            if (row.effect != Effect::result) continue;
            options.emplace_back(full_name(table, row), to_text(row.get()));
        }
    }
    return options;
}

void update(Configuration& configuration, const std::vector<OptionTable>& tables) {
    for (const OptionTable& table : tables) {
        for (const Option& row : table.rows()) {
            const auto recorded = std::ranges::find(configuration, full_name(table, row),
                                                    &Configuration::value_type::first);
            if (recorded != configuration.end()) recorded->second = to_text(row.get());
        }
    }
}

}  // namespace grainfield::pipelines
