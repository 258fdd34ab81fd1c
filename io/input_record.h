#pragma once

#include <filesystem>

#include "core/results.h"

namespace grainfield::io {

/// Name, size and CRC-32 (zlib, polynomial 0xEDB88320) of a file's content, to be stored with
/// whatever is made from it. Reads the file once in pieces of 1 MiB. Throws InputError if it cannot
/// be read.
RunRecord::Input describe_input(const std::filesystem::path& path);

}  // namespace grainfield::io
