#pragma once

#include <memory>
#include <vector>

#include "app/command.h"

namespace grainfield::app {

/// Reads the command line, runs the command, prints its summary, and returns the exit code of the
/// process. The only place that prints: the summary on standard output, warnings and errors on
/// standard error.
int run_command_line(int argc, const char* const* argv);

/// The same for a program of other commands.
int run_command_line(int argc, const char* const* argv,
                     std::vector<std::unique_ptr<Command>> commands);

}  // namespace grainfield::app
