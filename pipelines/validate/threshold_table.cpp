#include "pipelines/validate/threshold_table.h"

#include <cmath>

#include <fmt/format.h>

namespace grainfield::pipelines {

report::Table threshold_table(const std::vector<ThresholdCheck>& checks) {
    report::Table table;
    table.name = "thresholds";
    table.title = "Thresholds of the scene";
    table.columns = {{"value", "Measured", ""}, {"limit", "Limit", ""}, {"met", "", "", true}};
    for (const ThresholdCheck& c : checks) {
        const std::string limit = fmt::format("{} {:g}", c.is_least ? "≥" : "≤", c.limit);
        report::TableCell measured;
        if (std::isfinite(c.value)) measured = {c.value, fmt::format("{:.5g}", c.value), false};
        table.rows.push_back({c.unit == "-" ? c.name : c.name + " [" + c.unit + "]",
                              {measured,
                               {c.limit, limit, false},
                               {c.met() ? 1.0 : 0.0, c.met() ? "met" : "missed", !c.met()}}});
    }
    return table;
}

}  // namespace grainfield::pipelines
