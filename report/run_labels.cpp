#include "report/run_labels.h"

#include <algorithm>

namespace grainfield::report {

std::vector<RunIdentity> identities_of(const std::vector<Results>& runs) {
    std::vector<RunIdentity> identities;
    identities.reserve(runs.size());
    for (const Results& run : runs) identities.push_back(run.identity);
    return identities;
}

bool all_on_a_line(const std::vector<RunIdentity>& identities) {
    const auto is_run = [](const RunIdentity& identity) { return identity.role == RunRole::run; };
    return std::ranges::any_of(identities, is_run) &&
           std::ranges::all_of(identities, [&](const RunIdentity& identity) {
               return !is_run(identity) || identity.dimension == 1;
           });
}

std::string origin_text(const RunIdentity& identity) {
    return identity.role == RunRole::critical_point ? "critical" : series_text(identity);
}

std::vector<std::string> origins_of(const std::vector<RunIdentity>& identities) {
    std::vector<std::string> origins;
    for (const RunIdentity& identity : identities) {
        if (identity.role == RunRole::critical_point) continue;
        const std::string text = series_text(identity);
        if (std::ranges::find(origins, text) == origins.end()) origins.push_back(text);
    }
    return origins;
}

}  // namespace grainfield::report
