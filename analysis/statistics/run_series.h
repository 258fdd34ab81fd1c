#pragma once

#include <vector>

#include "core/figure_hint.h"
#include "core/quantity_titles.h"
#include "core/results.h"

namespace grainfield::analysis {

/// The time series that a simulation keeps of itself (energies, collisions, pressure), as one
/// observable named "series": the curves as they are, and the mean of every column over the later
/// half of its rows, with block errors (BlockPlan). A curve without rows or without a column "t"
/// has no means. Columns named "t" and "audit" are not averaged.
///
/// Column units are kept. Cost: O(rows).
ObservableResult run_series(std::vector<Curve> curves);

/// How the time series of a simulation want to be drawn.
std::vector<FigureHint> run_series_figures();
/// What the means of its columns are called.
ObservableTitles run_series_titles();

}  // namespace grainfield::analysis
