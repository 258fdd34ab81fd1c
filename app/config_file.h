#pragma once

#include <filesystem>
#include <string>
#include <vector>

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

/// The present values of the options as such a file. An option at its default stands as a comment,
/// each with its meaning; those that concern one call only are left out. `heading`: lines of the
/// comment at the top.
std::string config_text(const std::vector<OptionTable>& tables, const std::string& heading);

}  // namespace grainfield::app
