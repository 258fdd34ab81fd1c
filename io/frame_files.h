#pragma once

#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "core/frame_source.h"
#include "core/support/output_file.h"
#include "io/frame_file_options.h"
#include "io/frame_writer.h"
#include "io/images/image_formats.h"

namespace grainfield::io {

/// Opens camera frames: images, multi-page TIFFs, or videos; several of a kind are one film
/// (join_parts). Folders and patterns are resolved by recording_files before.
///
/// What no image format of `formats` recognises is opened as a video. The formats must outlive the
/// frames.
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
                                         const FrameFileOptions& options,
                                         std::span<const ImageFormat> formats = image_formats());

/// True for names ending in .avi or .mkv.
bool is_video_name(const std::filesystem::path& path);

/// A video (FFV1 version 3, lossless, with a checksum a slice; gray, gray10, gray12 or gray16)
/// where the name says so; else a folder, made if absent, of pictures frame-000000.tif numbered by
/// Frame::index, each appearing under its name when complete. Same frames → same bytes.
///
/// Throws OptionError if a video has no frame rate, OutputError as OutputFile does, or if an
/// existing folder holds frames already and Overwrite is refuse.
std::unique_ptr<FrameWriter> make_frame_writer(const std::filesystem::path& path,
                                               const FrameWriterOptions& options,
                                               Overwrite overwrite);

}  // namespace grainfield::io
