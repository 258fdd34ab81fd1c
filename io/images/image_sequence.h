#pragma once

#include <filesystem>
#include <memory>
#include <string_view>
#include <vector>

#include "core/frame_source.h"
#include "io/frame_files.h"

namespace grainfield::io {

enum class ImageKind { png, tiff, jpeg, bmp, pnm, none };

/// What the first bytes of a file say that it is.
ImageKind identify_image(std::string_view head);

/// Image files as frames, one each, in natural order; see open_frames.
std::unique_ptr<FrameSource> open_image_sequence(std::vector<std::filesystem::path> files,
                                                 const FrameFileOptions& options);

}  // namespace grainfield::io
