#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "io/output_file.h"

namespace grainfield::io {

enum class PictureFormat { tiff, png };

struct FrameWriterOptions {
    PictureFormat format = PictureFormat::tiff;  ///< of pictures in a folder
    int width = 0;                               ///< [px]
    int height = 0;                              ///< [px]
    int bit_depth = 8;                           ///< 8 … 16
    std::optional<double> fps;                   ///< [1/s]; videos need it
};

/// Receives camera frames, one at a time, and keeps their counts bit-exactly.
class FrameWriter {
 public:
    virtual ~FrameWriter() = default;

    /// Throws OptionError if size or bit depth differ from what was announced, or the frame has no
    /// image; OutputError if it cannot be written.
    virtual void write(const Frame& frame) = 0;
    /// Completes the output. Pictures written so far stay whatever happens; a video appears under
    /// its name only now.
    virtual void finish() = 0;
    virtual std::vector<std::filesystem::path> outputs() const = 0;
};

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
