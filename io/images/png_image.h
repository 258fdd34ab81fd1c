#pragma once

#include <cstdint>
#include <filesystem>

#include "io/images/picture.h"

namespace grainfield::io {

/// Decodes a PNG at full depth (1–16 bit; palettes as 8-bit luma; alpha dropped). Every checksum of
/// the pixel data is verified. Throws CorruptPicture for damaged or cut files, InputError above
/// `max_pixels`. Thread-safe.
Picture read_png(const std::filesystem::path& path, std::int64_t max_pixels);

}  // namespace grainfield::io
