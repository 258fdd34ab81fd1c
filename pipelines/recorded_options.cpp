#include "pipelines/recorded_options.h"

#include <algorithm>

namespace grainfield::pipelines {

Configuration recorded_options(const std::vector<OptionTable>& tables,
                               const std::vector<std::string_view>& left_out) {
    Configuration options;
    for (const OptionTable& table : tables) {
        const std::string prefix = table.section().empty() ? "" : table.section() + ".";
        for (const Option& row : table.rows()) {
            std::string name = prefix + row.name;
            if (std::ranges::find(left_out, name) != left_out.end()) continue;
            options.emplace_back(std::move(name), to_text(row.get()));
        }
    }
    return options;
}

}  // namespace grainfield::pipelines
