#pragma once

#include <cstdint>
#include <filesystem>

#include "io/images/image_format.h"

namespace grainfield::io {

/// Decodes a PNG at full depth (1–16 bit; palettes as 8-bit luma; alpha dropped). Every checksum of
/// the pixel data is verified. Throws CorruptPicture for damaged or cut files, InputError above
/// `max_pixels`. Thread-safe.
Picture read_png(const std::filesystem::path& path, std::int64_t max_pixels);

/// PNG; written as grey of 8 or 16 bit.
ImageFormat png_format();

}  // namespace grainfield::io
