#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/checkpoint.h"

namespace grainfield::io {

/// Writes a checkpoint under a temporary name, brings it to the disk and renames it, so that there
/// is always a whole one. Little-endian binary with version and CRC-32. Throws OutputError.
void write_checkpoint(const Checkpoint& checkpoint, const std::filesystem::path& path);

/// Throws InputError if the file is missing, damaged (length, CRC) or no checkpoint of this
/// version.
Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Throws OptionError naming every option that differs, with both values.
void require_same_configuration(
    const Checkpoint& checkpoint,
    const std::vector<std::pair<std::string, std::string>>& configuration,
    const std::filesystem::path& path);

}  // namespace grainfield::io
