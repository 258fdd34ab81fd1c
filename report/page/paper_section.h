#pragma once

#include <optional>
#include <string>
#include <vector>

#include "report/maps/particle_map.h"
#include "report/page/paper_panels.h"

namespace grainfield::report {

/// The figures of the paper in its own arrangement: the map of 1b beside its distribution; 2 as
/// rows of experiment, molecular dynamics and field by columns of S/S1, S0/S1 and σ²; 3, 4a, 4b.
/// `map`: drawn as 1b; null: there is none. The plots are filled in by the script of the page.
std::string paper_section_html(const std::vector<PaperPanel>& panels, const ParticleMap* map,
                               const std::string& map_label);

/// Of the maps that of Fig. 1b: the last one of its run; null where there is none.
const ParticleMap* paper_map(const std::vector<ParticleMap>& maps, std::optional<std::size_t> run);

}  // namespace grainfield::report
