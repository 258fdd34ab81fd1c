#pragma once

#include <pybind11/pybind11.h>

namespace grainfield::python {

/// Observables, results and reports.
void bind_measuring(pybind11::module_& module);

}  // namespace grainfield::python
