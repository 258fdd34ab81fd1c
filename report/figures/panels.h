#pragma once

#include <string>
#include <vector>

#include "report/figures/figure.h"
#include "report/run_labels.h"

namespace grainfield::report {

/// One figure for each origin, of its runs alone and in colours of their own, where several origins
/// share the given figure: as the columns of Fig. 2 (`castillo2019`). Origins with data of one run
/// or none give none. Names end in "_panel1" …, titles in the origin; labels lose the origin they
/// begin with. A panel of fields on a line has the guides that `guides` says for that, unless the
/// given figure has them already.
std::vector<Figure> panels_by_origin(const Figure& figure,
                                     const std::vector<RunIdentity>& identities,
                                     const std::vector<GuideHint>& guides = {});

/// The figure of those runs alone that have data in it, in colours of their own; no run is listed
/// as absent.
Figure of_present_runs(Figure figure);

}  // namespace grainfield::report
