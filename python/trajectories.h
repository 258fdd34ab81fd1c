#pragma once

#include <pybind11/pybind11.h>

namespace grainfield::python {

/// The class Trajectory of the compiled module, and reading one from a file.
void bind_trajectories(pybind11::module_& module);

}  // namespace grainfield::python
