#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "core/frame.h"
#include "io/images/image_format.h"

namespace grainfield::io {

struct FrameWriterOptions {
    const ImageFormat* format = nullptr;  ///< of pictures in a folder; nullptr: TIFF
    int width = 0;                        ///< [px]
    int height = 0;                       ///< [px]
    int bit_depth = 8;                    ///< 8 … 16
    std::optional<double> fps;            ///< [1/s]; videos need it
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
    /// Whether a whole picture of this Frame::index and of the announced shape stands in the output
    /// already. Never in a video, which holds nothing before finish().
    virtual bool holds(std::int64_t index) const = 0;
    virtual std::vector<std::filesystem::path> outputs() const = 0;
};

/// The counts of a frame as bytes, little-endian words above 8 bit. Throws OptionError where the
/// frame is not of the announced shape.
std::vector<std::uint8_t> counts_of(const Frame& frame, const FrameWriterOptions& options);

/// The image that these counts are of. Throws InputError if they are not as many as announced.
Image image_of(const std::vector<std::uint8_t>& counts, const FrameWriterOptions& options);

}  // namespace grainfield::io
