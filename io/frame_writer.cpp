#include "io/frame_writer.h"

#include <cstddef>

#include <fmt/format.h>

#include "core/errors.h"

namespace grainfield::io {

std::vector<std::uint8_t> counts_of(const Frame& frame, const FrameWriterOptions& options) {
    const Image& image = frame.image;
    if (image.width() != options.width || image.height() != options.height ||
        frame.bit_depth != options.bit_depth) {
        throw OptionError({.problem = fmt::format("frame {} does not fit its series", frame.index),
                           .actual = fmt::format("{} × {} pixels of {} bit", image.width(),
                                                 image.height(), frame.bit_depth),
                           .expected = fmt::format("{} × {} pixels of {} bit", options.width,
                                                   options.height, options.bit_depth),
                           .suggestion = {}});
    }
    std::vector<std::uint8_t> bytes;
    if (options.bit_depth <= 8) {
        bytes.resize(image.size());
        for (std::size_t i = 0; i < image.size(); ++i) {
            bytes[i] = static_cast<std::uint8_t>(image.pixels()[i]);
        }
        return bytes;
    }
    bytes.resize(2 * image.size());
    for (std::size_t i = 0; i < image.size(); ++i) {
        const auto count = static_cast<std::uint16_t>(image.pixels()[i]);
        bytes[2 * i] = static_cast<std::uint8_t>(count & 255U);
        bytes[2 * i + 1] = static_cast<std::uint8_t>(count >> 8U);
    }
    return bytes;
}

Image image_of(const std::vector<std::uint8_t>& counts, const FrameWriterOptions& options) {
    Image image(options.width, options.height);
    const std::size_t size = options.bit_depth <= 8 ? 1 : 2;
    if (counts.size() != size * image.size()) {
        throw InputError({.problem = "these counts are of another image",
                          .actual = fmt::format("{} bytes", counts.size()),
                          .expected = fmt::format("{}", size * image.size()),
                          .suggestion = {}});
    }
    for (std::size_t i = 0; i < image.size(); ++i) {
        const unsigned high = size == 1 ? 0U : static_cast<unsigned>(counts[2 * i + 1]) << 8U;
        image.pixels()[i] = static_cast<float>(counts[size * i] + high);
    }
    return image;
}

}  // namespace grainfield::io
