#pragma once

#include <string>
#include <vector>

#include "core/figure_hint.h"
#include "report/figures/figure.h"
#include "report/figures/figure_source.h"

namespace grainfield::report {

/// Whether a report of these runs shows the figure (FigureHint::presence).
bool is_present(const Runs& runs, const FigureHint& hint);

/// The figure that a hint describes, runs side by side. On a logarithmic axis only positive values
/// are kept, unless the figure may be linear. Runs that have none of the hint's first curve are
/// listed in `Figure::absent` with the reason.
Figure hinted_figure(const Runs& runs, const std::vector<std::string>& labels,
                     const FigureHint& hint);

}  // namespace grainfield::report
