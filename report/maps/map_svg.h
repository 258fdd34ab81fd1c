#pragma once

#include <string>

#include "report/maps/particle_map.h"

namespace grainfield::report {

/// The map as a picture of its own: the frame, discs at 85 % of the diameter coloured by |Q4|
/// (grey where unknown), colour bar. Discs of one colour (32 steps) are one path of dots with round
/// caps, so that 10,000 of them take about 150 kB.
std::string map_svg(const ParticleMap& map, const std::string& run_label);

}  // namespace grainfield::report
