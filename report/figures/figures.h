#pragma once

#include <string>
#include <vector>

#include "core/figure_hint.h"
#include "core/results.h"
#include "report/figures/figure.h"

namespace grainfield::report {

/// One label a run, clean, not empty, at most 60 characters, no two the same: the label of the
/// results, else the name of the first input, else "run 1".
std::vector<std::string> run_labels(const std::vector<Results>& runs);

/// The figures of a report, runs side by side on shared axes: S0/S1 against each control parameter,
/// those that `hints` describe by growing place, and S(k)/S1; some also for each origin alone,
/// where there are several. A run that lacks a curve is listed with its reason in `Figure::absent`.
std::vector<Figure> make_figures(const std::vector<Results>& runs,
                                 const std::vector<std::string>& labels,
                                 std::vector<FigureHint> hints);

}  // namespace grainfield::report
