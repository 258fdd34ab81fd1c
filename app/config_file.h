#pragma once

#include <filesystem>

#include "app/option_set.h"

namespace grainfield::app {

/// Sets every option that stands in the TOML file `path`.
///
///     threads = 2            # command-wide
///     [detect]
///     threshold = 0.4
///
/// Throws InputError if the file cannot be read. Throws OptionError, naming file and line, if it is
/// not TOML, has an unknown key or section (with the nearest known one), or a value of the wrong
/// kind or out of range. Options set before the faulty line stay set.
void apply_config_file(const std::filesystem::path& path, const OptionSet& options);

}  // namespace grainfield::app
