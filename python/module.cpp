#include <pybind11/pybind11.h>

#include "core/version.h"
#include "python/errors.h"
#include "python/measuring.h"
#include "python/released.h"
#include "python/simulation.h"
#include "python/tracking.h"
#include "python/trajectories.h"

namespace py = pybind11;

PYBIND11_MODULE(_grainfield, module) {
    using namespace grainfield::python;
    module.doc() =
        "Compiled part of the package grainfield: its functions take what the package "
        "has checked. Not for users.";
    module.attr("version") = grainfield::kVersion;
    bind_errors(module);
    bind_trajectories(module);
    bind_tracking(module);
    bind_measuring(module);
    bind_simulation(module);
    py::module_::import("atexit").attr("register")(py::cpp_function(&stop_workers));
}
