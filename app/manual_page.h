#pragma once

#include <string>

#include "app/command_page.h"

namespace grainfield::app {

/// "grainfield-simulate-md", the name of a command's manual page; "grainfield" of the program.
std::string manual_name(const std::string& command);

/// The manual page (section 1) of one command, in the macros of man(7): all options with unit,
/// range and default.
std::string manual_page(const CommandPage& page);

/// The manual page of the program: its commands and its own options.
std::string manual_page(const ProgramPage& page);

}  // namespace grainfield::app
