#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/results.h"

namespace grainfield::report {

/// Beside films, whose times are in seconds, simulations get theirs in seconds too, where the true
/// diameter a of the spheres is known [mm]: a unit of time is √(a/g), g = 9.80665 m/s². All curves
/// and numbers with time in their unit are converted, with the frame rate and the times of the
/// previews. `sphere_mm` is the given diameter; empty: that which a simulation states for itself,
/// else that of the films if they agree within 1 %.
///
/// Returns what was done, in one sentence for the figures with times; empty if nothing was.
std::string share_seconds(std::vector<Results>& runs, std::optional<double> sphere_mm);

}  // namespace grainfield::report
