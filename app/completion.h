#pragma once

#include <string>

#include "app/command_page.h"

namespace grainfield::app {

// Scripts that complete commands, options and the values of choices on a command line. A value that
// is text completes to names of files, a number to nothing.

/// For bash 4 and later; needs no other package.
std::string bash_completion(const ProgramPage& page);

/// For zsh, as the file `_grainfield` in a folder of `fpath`.
std::string zsh_completion(const ProgramPage& page);

/// For fish, as the file `grainfield.fish` in a folder of completions.
std::string fish_completion(const ProgramPage& page);

}  // namespace grainfield::app
