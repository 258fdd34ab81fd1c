#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "core/errors.h"
#include "core/frame.h"
#include "core/frame_source.h"
#include "io/colour_filter.h"

namespace grainfield::io {

/// Width, height [px] and bits per sample of a picture.
struct PictureShape {
    int width = 0;
    int height = 0;
    int bit_depth = 0;

    /// "1012 × 1012 pixels of 8 bit"
    std::string text() const;
    friend bool operator==(const PictureShape&, const PictureShape&) = default;
};

/// One decoded picture: the counts of the file, colour reduced to luma.
struct Picture {
    Image image;
    int bit_depth = 8;
    ColourFilter filter = ColourFilter::none;  ///< as the file says
    std::optional<double> frame_rate = {};     ///< of the film it is of, as the file says [1/s]

    PictureShape shape() const { return {image.width(), image.height(), bit_depth}; }
};

/// The file is of the right kind but this picture in it is damaged; the text is the decoder's. A
/// source of several frames turns it into FrameStatus::corrupt.
class CorruptPicture : public InputError {
 public:
    CorruptPicture(const std::filesystem::path& path, const std::string& decoder_message);
    const std::string& decoder_message() const { return decoder_message_; }

 private:
    std::string decoder_message_;
};

/// The only frame of a film, for callers that want one picture. Throws InputError if the film has
/// several frames or if the first one is damaged.
Picture only_picture(FrameSource& film, const std::filesystem::path& path);

/// For frames of a colour filter that the options do not name.
std::string mosaic_warning(const std::string& file, ColourFilter filter);

/// Rec. 601 luma in the counts of its arguments; exact where all three are equal and ≤ 65535.
inline float luma(std::int32_t red, std::int32_t green, std::int32_t blue) {
    return static_cast<float>(299 * red + 587 * green + 114 * blue) / 1000.0F;
}

/// Throws InputError if either side is not positive or the area exceeds `max_pixels`.
void require_pixel_count(const std::filesystem::path& path, std::int64_t width, std::int64_t height,
                         std::int64_t max_pixels);

/// Throws InputError naming frame and file if `found` differs from `expected`.
void require_same_shape(const std::filesystem::path& path, std::int64_t frame,
                        const PictureShape& found, const PictureShape& expected);

/// Throws OutputError.
[[noreturn]] void fail_to_write(const std::filesystem::path& path, const std::string& reason);

/// Throws OptionError unless 0 ≤ index < count.
void require_frame_index(std::int64_t index, std::int64_t count, const std::string& source);

}  // namespace grainfield::io
