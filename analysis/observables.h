#pragma once

#include <string>
#include <vector>

#include "analysis/observable.h"

namespace grainfield::analysis {

/// All observables of the program, in the order of their results.
const std::vector<Observable>& observables();

/// The observables that a comma list such as "q4,sk" names, or all of them for "all", in the order
/// of `known`. Throws OptionError naming the unknown entry, or if the list is empty.
std::vector<Observable> chosen(const std::string& list, const std::vector<Observable>& known);

/// How all observables want to be drawn, those of fields and of simulations included.
std::vector<FigureHint> figure_hints(const std::vector<Observable>& known = observables());

}  // namespace grainfield::analysis
