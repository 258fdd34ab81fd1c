#include "python/errors.h"

#include <exception>
#include <string>

#include "core/errors.h"

namespace py = pybind11;

namespace grainfield::python {

namespace {

// They live as long as the process: exceptions may be thrown until its end.
PyObject *error_type, *option_type, *input_type, *output_type, *physics_type, *warning_type;

PyObject* make_type(py::module_& module, const char* name, const char* meaning,
                    const py::tuple& bases) {
    const std::string full = std::string("grainfield.") + name;
    PyObject* type = PyErr_NewExceptionWithDoc(full.c_str(), meaning, bases.ptr(), nullptr);
    if (type == nullptr) throw py::error_already_set();
    module.add_object(name, py::reinterpret_borrow<py::object>(type));
    return type;
}

py::tuple bases(PyObject* first, PyObject* second = nullptr) {
    const auto type = [](PyObject* t) { return py::reinterpret_borrow<py::object>(t); };
    return second == nullptr ? py::make_tuple(type(first))
                             : py::make_tuple(type(first), type(second));
}

void translate(std::exception_ptr pointer) {
    try {
        if (pointer) std::rethrow_exception(pointer);
    } catch (const OptionError& error) {
        PyErr_SetString(option_type, error.what());
    } catch (const InputError& error) {
        PyErr_SetString(input_type, error.what());
    } catch (const OutputError& error) {
        PyErr_SetString(output_type, error.what());
    } catch (const PhysicsError& error) {
        PyErr_SetString(physics_type, error.what());
    } catch (const Interrupted& error) {
        PyErr_SetString(PyExc_KeyboardInterrupt, error.what());
    } catch (const Error& error) {
        PyErr_SetString(error_type, error.what());
    }
}

}  // namespace

void bind_errors(py::module_& module) {
    error_type = make_type(module, "Error", "Base of everything that grainfield raises.",
                           bases(PyExc_RuntimeError));
    option_type = make_type(module, "OptionError", "An option is unknown or has a wrong value.",
                            bases(error_type, PyExc_ValueError));
    input_type = make_type(module, "InputError",
                           "Input that is missing, unreadable or not what it claims to be.",
                           bases(error_type, PyExc_ValueError));
    output_type = make_type(module, "OutputError",
                            "Output that cannot be written: permissions, disk full, file in use.",
                            bases(error_type));
    physics_type = make_type(module, "PhysicsError",
                             "A physics check failed: overlap, stalled clock, inelastic collapse.",
                             bases(error_type, PyExc_ArithmeticError));
    warning_type = make_type(module, "GrainfieldWarning", "What a user should know of a result.",
                             bases(PyExc_UserWarning));
    py::register_exception_translator(&translate);
}

namespace {

/// How many calls up the first one outside of the package is: there the warning belongs.
int level_of_caller() {
    int level = 1;
    py::object frame = py::module_::import("sys").attr("_getframe")(0);
    while (!frame.is_none()) {
        const std::string module = py::str(frame.attr("f_globals").attr("get")("__name__", ""));
        if (!module.starts_with("grainfield")) return level;
        frame = frame.attr("f_back");
        ++level;
    }
    return 1;
}

}  // namespace

void pass_on(const RunPlan& plan) {
    if (plan.warnings().empty()) return;
    const int level = level_of_caller();
    for (const Warning& warning : plan.warnings()) {
        if (PyErr_WarnEx(warning_type, warning.text.c_str(), level) != 0) {
            throw py::error_already_set();
        }
    }
}

}  // namespace grainfield::python
