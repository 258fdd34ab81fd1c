#pragma once

#include <cstddef>
#include <cstdint>

namespace grainfield::analysis {

/// A summed-area table modulo 2^16, row after row; `padding` entries behind the last row may be
/// read.
struct NarrowTable {
    static constexpr std::size_t padding = 64;
    /// Windows hold at most this, so that a content is a positive number of 16 bits.
    static constexpr std::uint32_t most = 32767;

    const std::uint16_t* value = nullptr;
    std::size_t stride = 0;  ///< from row to row
};

struct NarrowSums {
    std::uint64_t sum = 0;      ///< Σ N
    std::uint64_t squares = 0;  ///< Σ N²
};

/// Sums over the windows of m × m cells with lower corners on the first `columns` × `rows` grid
/// points. `largest`: no window holds more, at most NarrowTable::most. Exact as long as the sums
/// stay below 2^64. 16 windows take about three cycles with AVX2.
NarrowSums window_sums(const NarrowTable& table, std::size_t m, std::size_t columns,
                       std::size_t rows, std::uint32_t largest);

}  // namespace grainfield::analysis
