#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/frame.h"

namespace grainfield::report {

/// The frame as an 8-bit grey PNG for people to look at: averaged over squares of `reduction`
/// pixels, counts from the darkest to the brightest permille stretched to 0 … 255 (a uniform image
/// becomes mid-grey). Pixels beyond the last whole square are left out. Throws OutputError if
/// libpng fails.
std::vector<std::uint8_t> encode_png(const Image& image, int reduction);

/// Red, green and blue of each pixel, row 0 on top, as a PNG; quick rather than small. Throws
/// OutputError if libpng fails.
std::vector<std::uint8_t> encode_png(std::span<const std::uint8_t> rgb, int width, int height);

}  // namespace grainfield::report
