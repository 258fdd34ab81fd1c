#pragma once

#include <string>

#include "core/results.h"

namespace grainfield::report {

/// S(k) by wavevector as a picture: both half planes, colour by the logarithm of S between its 1st
/// and 99th percentile, colour bar. Wavevectors of one colour (32 steps) are one path. Empty if the
/// run has no curve `sk_map` with positive values.
std::string spectrum_map_svg(const Results& run, const std::string& run_label);

}  // namespace grainfield::report
