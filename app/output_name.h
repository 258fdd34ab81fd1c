#pragma once

#include <filesystem>

namespace grainfield::app {

/// Whether a name reads as that of a folder: a folder that is there, a name with '/' at its end, or
/// one without an extension that begins with a letter ("curves", "run.7", "gamma4.35").
bool is_folder_name(const std::filesystem::path& output);

}  // namespace grainfield::app
