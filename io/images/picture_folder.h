#pragma once

#include <filesystem>
#include <memory>

#include "core/support/output_file.h"
#include "io/frame_writer.h"

namespace grainfield::io {

/// The folder of pictures of make_frame_writer. Throws OptionError if the format is only read.
std::unique_ptr<FrameWriter> make_picture_folder(const std::filesystem::path& path,
                                                 const FrameWriterOptions& options,
                                                 Overwrite overwrite);

}  // namespace grainfield::io
