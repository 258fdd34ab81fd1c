#pragma once

#include <string>

#include "report/figures/figure.h"

namespace grainfield::report {

/// The figure as JSON for page.js, fit for <script>: `name`, `toggle`, `runs` and `kinds` for the
/// legend, `traces` and `layout` as Plotly takes them; each trace carries `meta: {run, kind}`.
/// Numbers have six digits; NaN becomes null.
std::string plotly_json(const Figure& figure);

}  // namespace grainfield::report
