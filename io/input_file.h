#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace grainfield::io {

/// Throws InputError, naming the path and a remedy, if there is nothing of this name.
void require_file_exists(const std::filesystem::path& path);

/// Throws InputError, naming the path and a remedy, unless it is a non-empty readable regular file.
void require_input_file(const std::filesystem::path& path);

/// Up to `limit` first bytes of a file; throws InputError if it cannot be read.
std::string read_head(const std::filesystem::path& path, std::size_t limit);

/// The whole content; throws InputError if it cannot be read or is longer than `limit` bytes.
std::string read_content(const std::filesystem::path& path, std::size_t limit);

/// Bytes for a message: printable ones as they are, others as \xNN, at most 16 of them.
std::string printable(std::string_view bytes);

}  // namespace grainfield::io
