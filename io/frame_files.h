#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/frame_source.h"

namespace grainfield::io {

struct FrameFileOptions {
    std::optional<double> fps;              ///< [1/s]; gives or overrides the frame rate
    std::int64_t max_pixels = 200'000'000;  ///< [px] larger frames are refused before allocating
};

/// Opens camera frames: one image, a list of images, one multi-page TIFF, or one video.
///
/// Pixels keep the counts of the file: 8 to 16 bit, bit-exact where the file is lossless; of YUV
/// the Y plane, of RGB the luma (299 R + 587 G + 114 B) / 1000; alpha is dropped. Lists are put in
/// natural order (2 before 10). If all names share one pattern with one running number, an index
/// whose number is absent becomes a frame of status `missing`. Files of a list are looked at
/// when read; only the first is decoded here. A damaged picture of a list or video is a frame of
/// status `corrupt`; where it is the only one, opening throws.
///
/// Throws InputError, naming the file, what was found, what was expected and a remedy, for
/// missing, empty, unreadable or foreign files, folders, pictures above `max_pixels`; `read` throws
/// it, with the frame number, when size or bit depth change. Throws OptionError unless fps is a
/// finite positive number and max_pixels at least 1.
std::unique_ptr<FrameSource> open_frames(const std::vector<std::filesystem::path>& inputs,
                                         const FrameFileOptions& options);

}  // namespace grainfield::io
