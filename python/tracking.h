#pragma once

#include <pybind11/pybind11.h>

namespace grainfield::python {

/// Locating, tracking and linking.
void bind_tracking(pybind11::module_& module);

}  // namespace grainfield::python
