#pragma once

#include <string>

#include "report/maps/particle_map.h"

namespace grainfield::report {

/// The map as a page of PDF: discs at 85 % of the diameter coloured by |Q4|, frame, colour bar, run
/// and frame in the document's title. Vectors only: the camera's picture is in the SVG. 10,000
/// discs take about 300 kB.
std::string map_pdf(const ParticleMap& map, const std::string& run_label);

}  // namespace grainfield::report
