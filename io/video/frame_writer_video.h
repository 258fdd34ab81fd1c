#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <vector>

#include "io/images/frame_writer.h"

namespace grainfield::io {

/// The counts of a frame as bytes, little-endian words above 8 bit. Throws OptionError where the
/// frame is not of the announced shape.
std::vector<std::uint8_t> counts_of(const Frame& frame, const FrameWriterOptions& options);

/// The video writer of make_frame_writer.
std::unique_ptr<FrameWriter> make_video_writer(const std::filesystem::path& path,
                                               const FrameWriterOptions& options,
                                               Overwrite overwrite);

}  // namespace grainfield::io
