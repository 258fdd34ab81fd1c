#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include "io/h5/detail/h5_group.h"

namespace grainfield::io {

/// A 64-bit digest of bytes in their order: eight at a time through two multiplications and
/// rotations, finished by MurmurHash3's mixer. Some 3 GB/s.
class DataDigest {
 public:
    void add(std::span<const std::byte> bytes);
    void add(std::string_view text);
    void add(std::uint64_t number) { mix(number); }
    std::string text() const;  ///< 16 hexadecimal digits

 private:
    void mix(std::uint64_t word);
    std::uint64_t state_ = 0x9e3779b97f4a7c15;
    std::uint64_t length_ = 0;
};

/// Of all arrays and descriptions below `group`, in alphabetical order (Fingerprint).
std::string digest_of(const H5Group& group);

/// Stores it beside the data. Not after a signal: a run that must end has no time to read.
void store_digest(const H5File& file);

/// The attribute of the root that holds it.
constexpr const char* digest_name = "fingerprint";

}  // namespace grainfield::io
