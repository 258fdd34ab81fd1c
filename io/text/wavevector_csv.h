#pragma once

#include <filesystem>
#include <vector>

#include "core/vec2.h"

namespace grainfield::io {

/// Wavevectors from a table of two columns kx,ky [1/a], one a line. A first line that holds names
/// is passed over where they are kx and ky; so are empty lines and comments that start with #.
///
/// Throws InputError, naming file, line and field, for anything else, and if there are none.
std::vector<Vec2> read_wavevectors(const std::filesystem::path& path);

}  // namespace grainfield::io
