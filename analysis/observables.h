#pragma once

#include <string>
#include <vector>

#include "analysis/observable.h"

namespace grainfield::analysis {

/// All observables of the program, in the order of their results.
const std::vector<Observable>& observables();

/// What can be asked for: "all" and the names of `known`.
std::vector<std::string> names_for(const std::vector<Observable>& known);

/// The observables of these names, or all of them for "all", in the order of `known`. Throws
/// OptionError naming the unknown one, or if none is named.
std::vector<Observable> chosen(const std::vector<std::string>& wanted,
                               const std::vector<Observable>& known);

/// How all observables want to be drawn, those of fields and of simulations included.
std::vector<FigureHint> figure_hints(const std::vector<Observable>& known = observables());

/// What all observables and their measurements are called, those of fields, of simulations and of
/// critical points included.
std::vector<ObservableTitles> titles(const std::vector<Observable>& known = observables());

}  // namespace grainfield::analysis
