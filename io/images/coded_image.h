#pragma once

#include <cstdint>
#include <filesystem>

#include "io/images/image_sequence.h"
#include "io/images/picture.h"

namespace grainfield::io {

/// Decodes a JPEG, BMP or PNM file through libavcodec; JPEG gives its luma plane. Throws
/// CorruptPicture for damaged or cut files, InputError above `max_pixels`. Thread-safe.
Picture read_coded_image(const std::filesystem::path& path, ImageKind kind,
                         std::int64_t max_pixels);

}  // namespace grainfield::io
