#pragma once

#include <filesystem>
#include <memory>

#include "core/frame_source.h"
#include "io/frame_file_options.h"

namespace grainfield::io {

/// The first video stream of a file as frames, in order of presentation.
///
/// On opening, every packet is read once without decoding: count() is what is there, not what a
/// header claims. Frames read in order never seek; any other order seeks to the key frame before
/// and decodes on. Grey and planar YUV formats deliver their first plane at full depth.
///
/// A frame is corrupt if the decoder reports an error for it (return value, frame flags, or its
/// log, which is all that FFV1's slice checksums speak to), or if it depends on such a frame; the
/// message is the decoder's. The same frames are corrupt in any order of reading. A cut file keeps
/// its whole frames; a warning says so. A frame rate that the timestamps contradict by more than
/// 2 %, or that the container only guesses, is not reported.
///
/// Replaces the process-wide log callback of libav by one that keeps messages and never prints.
/// Throws InputError if there is no video of a known format, or nothing of it can be read.
std::unique_ptr<FrameSource> open_video(const std::filesystem::path& path,
                                        const FrameFileOptions& options);

}  // namespace grainfield::io
