#pragma once

#include <string>
#include <vector>

#include "core/results.h"
#include "report/figures/figure.h"

namespace grainfield::report {

/// The name of the control parameter of results of `critical`; empty of others.
std::string critical_parameter(const Results& run);

/// S0/S1 with its line, of results of `critical`: one figure for each control parameter, as Γ and ν
/// share no axis, called "critical", "critical_2" …. Where the line meets zero is marked, with its
/// interval. Then "critical_epsilon", all of them against
/// the distance ε = (Γc − Γ)/Γc (`castillo2019`, Fig. 2b, e), where critical points meet at zero.
/// It has the runs whose Γc is known to a quarter of itself; ν is a distance already.
std::vector<Figure> critical_figures(const std::vector<Results>& runs,
                                     const std::vector<std::string>& labels);

}  // namespace grainfield::report
