#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace grainfield::io {

/// What identifies the data of a file of ours: a digest of every array and description in it.
///
/// Left out is what differs between runs that made the same data: the record (threads, wall time,
/// names of files), the records of its sources, seconds and labels in descriptions, and how HDF5
/// laid them out. 64 bits, against chance and damage, not against forgery.
struct Fingerprint {
    std::string data;                   ///< of the data as they are, 16 hexadecimal digits
    std::optional<std::string> stored;  ///< as its writer found it; none in older files
};

/// Reads the whole file, row after row. Throws InputError if it is no HDF5 file or damaged.
Fingerprint fingerprint_of(const std::filesystem::path& path);

}  // namespace grainfield::io
