#pragma once

#include <pybind11/pybind11.h>

#include "core/run_plan.h"

namespace grainfield::python {

/// Python exceptions of the names of core/errors.h, in `module`: Error, a RuntimeError; the others
/// derive from it, OptionError and InputError from ValueError too, PhysicsError from
/// ArithmeticError too. Interrupted becomes KeyboardInterrupt. Warnings of a plan are of the
/// category GrainfieldWarning.
void bind_errors(pybind11::module_& module);

/// Warns with the text of each warning of the plan.
void pass_on(const RunPlan& plan);

}  // namespace grainfield::python
