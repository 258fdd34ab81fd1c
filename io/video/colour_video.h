#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "core/support/output_file.h"

namespace grainfield::io {

struct ColourVideoOptions {
    int width = 0;        ///< [px]; an odd size loses its last column or row
    int height = 0;       ///< [px]
    double fps = 25;      ///< [1/s]
    double quality = 20;  ///< constant rate factor of H.264: 0 lossless … 51
};

/// A video for people to look at, not to measure: H.264 where libavcodec has an encoder for it,
/// else MPEG-4 part 2, colours as YUV 4:2:0 (ITU-R BT.601, limited range).
class ColourVideo {
 public:
    /// Names that end in .mp4, .mkv or .mov. Throws OptionError for other names or no frame size,
    /// OutputError as OutputFile does or if there is no encoder.
    ColourVideo(const std::filesystem::path& path, const ColourVideoOptions& options,
                Overwrite overwrite);
    ~ColourVideo();
    ColourVideo(const ColourVideo&) = delete;
    ColourVideo& operator=(const ColourVideo&) = delete;

    /// Red, green, blue of each pixel, width × height × 3 bytes, row 0 on top. Throws OptionError
    /// if the size differs from what was announced, OutputError if it cannot be written.
    void write(std::span<const std::uint8_t> rgb);
    /// Completes the video, which appears under its name only now.
    void finish();

 private:
    friend void write_jpeg(const std::filesystem::path& path, std::span<const std::uint8_t> rgb,
                           int width, int height, Overwrite overwrite);
    class Encoder;
    std::unique_ptr<Encoder> encoder_;
};

/// One picture for people to look at, as JPEG. An odd size loses its last column or row. Throws
/// OptionError for a wrong number of bytes, OutputError.
void write_jpeg(const std::filesystem::path& path, std::span<const std::uint8_t> rgb, int width,
                int height, Overwrite overwrite);

/// True for names that ColourVideo writes.
bool is_colour_video_name(const std::filesystem::path& path);

}  // namespace grainfield::io
