#pragma once

#include <filesystem>
#include <memory>

#include "core/support/output_file.h"
#include "io/frame_writer.h"

namespace grainfield::io {

/// The video writer of make_frame_writer.
std::unique_ptr<FrameWriter> make_video_writer(const std::filesystem::path& path,
                                               const FrameWriterOptions& options,
                                               Overwrite overwrite);

}  // namespace grainfield::io
