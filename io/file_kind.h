#pragma once

#include <filesystem>

namespace grainfield::io {

/// What a file holds; `unknown` is anything else, images and videos included.
enum class FileKind { trajectory, results, field, points, unknown };

/// Looks at the content, not at the name. Folders are unknown. Throws InputError if there is no
/// such file, it cannot be read, or it is an HDF5 file that is damaged.
FileKind identify(const std::filesystem::path& path);

}  // namespace grainfield::io
