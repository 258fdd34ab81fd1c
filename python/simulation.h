#pragma once

#include <pybind11/pybind11.h>

namespace grainfield::python {

/// Molecular dynamics, the field model, rendered frames.
void bind_simulation(pybind11::module_& module);

}  // namespace grainfield::python
