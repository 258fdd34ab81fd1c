#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "core/frame_source.h"
#include "io/frame_file_options.h"
#include "io/images/image_format.h"

namespace grainfield::io {

/// Image files as frames, one each, in natural order; see open_frames. `formats` must outlive it.
std::unique_ptr<FrameSource> open_image_sequence(std::vector<std::filesystem::path> files,
                                                 const FrameFileOptions& options,
                                                 std::span<const ImageFormat> formats);

}  // namespace grainfield::io
