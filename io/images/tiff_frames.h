#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>

#include "core/frame_source.h"
#include "io/frame_file_options.h"
#include "io/images/picture.h"

namespace grainfield::io {

/// The pages of one TIFF as frames; pages marked as reduced images are left out.
///
/// Reads grey of 8 to 16 bit, packed or not, and RGB(A) or palette of 8 or 16 bit, in strips or
/// tiles, any compression of libtiff. Of DNG the counts of the sensor are read, also below the page
/// of a small picture; the whole sensor with its dark border, without the tables that DNG has for
/// viewers. A warning names the colour filter. JPEG is refused there.
/// `min-is-white` is inverted, so that bright is always large. The list of pages is walked on
/// opening; where it breaks off, the pages before are kept and a warning says so. A page whose
/// pixels are damaged or cut is a corrupt frame with libtiff's message; if it is the only page,
/// opening throws.
std::unique_ptr<FrameSource> open_tiff(const std::filesystem::path& path,
                                       const FrameFileOptions& options);

/// The single page of a TIFF. Throws CorruptPicture for damaged files, InputError if there are more
/// pages or for a kind of picture that is not supported. Thread-safe.
Picture read_tiff(const std::filesystem::path& path, std::int64_t max_pixels);

}  // namespace grainfield::io
