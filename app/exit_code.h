#pragma once

#include <exception>

namespace grainfield::app {

/// What the process tells its caller.
enum class ExitCode : int {
    done = 0,
    failed = 1,
    wrong_usage = 2,
    bad_input = 3,
    output_failed = 4,
    physics_failed = 5,
};

/// The number that a failure ends the process with: one of ExitCode, or 128 + signal (130, 143)
/// after an interrupt.
int exit_code(const std::exception& failure);

/// Same for a signal that ended the work early but in good order.
int exit_code(int signal);

}  // namespace grainfield::app
