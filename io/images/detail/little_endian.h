#pragma once

#include <cstdint>

namespace grainfield::io {

/// The number in `count` bytes, the low one first.
inline std::uint64_t word(const std::uint8_t* bytes, unsigned count) {
    std::uint64_t value = 0;
    for (unsigned i = 0; i < count; ++i) value |= std::uint64_t{bytes[i]} << (8U * i);
    return value;
}

}  // namespace grainfield::io
