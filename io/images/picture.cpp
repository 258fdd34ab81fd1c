#include "io/images/picture.h"

#include <cctype>
#include <utility>

#include <fmt/format.h>

namespace grainfield::io {

std::string PictureShape::text() const {
    return fmt::format("{} × {} pixels of {} bit", width, height, bit_depth);
}

CorruptPicture::CorruptPicture(const std::filesystem::path& path,
                               const std::string& decoder_message)
    : InputError({.problem = fmt::format("'{}' is damaged", path.string()),
                  .actual = decoder_message,
                  .expected = "a whole picture",
                  .suggestion = "copy the file again from where it was recorded"}),
      decoder_message_(decoder_message) {}

Picture only_picture(FrameSource& film, const std::filesystem::path& path) {
    Frame frame = film.read(0);
    if (film.count() == 1 && frame.status == FrameStatus::ok) {
        return {std::move(frame.image), frame.bit_depth};
    }
    throw InputError({.problem = fmt::format("'{}' is not one picture", path.string()),
                      .actual = frame.status == FrameStatus::ok
                                    ? fmt::format("it holds {} frames", film.count())
                                    : frame.message,
                      .expected = "one frame",
                      .suggestion = "give it as a film"});
}

std::string mosaic_warning(const std::string& file, ColourFilter filter) {
    std::string pattern;
    if (filter != ColourFilter::none) pattern = fmt::format(" {}", name_of(filter));
    for (char& c : pattern) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return fmt::format("'{}' holds the mosaic of a colour camera: give option 'mosaic'{}", file,
                       pattern);
}

void require_pixel_count(const std::filesystem::path& path, std::int64_t width, std::int64_t height,
                         std::int64_t max_pixels) {
    constexpr std::int64_t largest_side = 1'000'000'000;
    const bool sane = width > 0 && height > 0 && width <= largest_side && height <= largest_side;
    if (sane && width * height <= max_pixels) return;
    throw InputError({.problem = fmt::format("picture size of '{}' is refused", path.string()),
                      .actual = fmt::format("{} × {} pixels", width, height),
                      .expected = fmt::format("1 … {} pixels", max_pixels),
                      .suggestion = "raise option 'max-pixels' if the file is really meant"});
}

void require_same_shape(const std::filesystem::path& path, std::int64_t frame,
                        const PictureShape& found, const PictureShape& expected) {
    if (found == expected) return;
    throw InputError(
        {.problem = fmt::format("frame {} ('{}') differs in size or depth", frame, path.string()),
         .actual = found.text(),
         .expected = fmt::format("{}, as in the first frame", expected.text()),
         .suggestion = "leave the frame out or process the parts one by one"});
}

void require_frame_index(std::int64_t index, std::int64_t count, const std::string& source) {
    if (index >= 0 && index < count) return;
    throw OptionError({.problem = fmt::format("no such frame in '{}'", source),
                       .actual = fmt::format("frame {}", index),
                       .expected = fmt::format("0 … {}", count - 1),
                       .suggestion = {}});
}

void fail_to_write(const std::filesystem::path& path, const std::string& reason) {
    throw OutputError({.problem = fmt::format("cannot write '{}'", path.string()),
                       .actual = reason,
                       .expected = {},
                       .suggestion = "check the free space and quota of that disk"});
}

}  // namespace grainfield::io
