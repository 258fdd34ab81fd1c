#pragma once

#include <string>
#include <vector>

#include "core/results.h"

namespace grainfield::report {

std::vector<RunIdentity> identities_of(const std::vector<Results>& runs);

/// Whether there are runs of fields on a line and nothing else.
bool all_on_a_line(const std::vector<RunIdentity>& identities);

/// What runs are switched on and off by: the text of the series, "critical" for critical points.
std::string origin_text(const RunIdentity& identity);

/// The texts of the series in the order of first appearance, critical points left out.
std::vector<std::string> origins_of(const std::vector<RunIdentity>& identities);

}  // namespace grainfield::report
