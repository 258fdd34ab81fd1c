#include "report/maps/png.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include <png.h>

#include "core/errors.h"

namespace grainfield::report {

namespace {

struct Grey {
    int width = 0;
    int height = 0;
    std::vector<float> value;
};

Grey reduced(const Image& image, int reduction) {
    Grey grey{image.width() / reduction, image.height() / reduction, {}};
    grey.value.reserve(static_cast<std::size_t>(grey.width) *
                       static_cast<std::size_t>(grey.height));
    const float scale = 1.0F / static_cast<float>(reduction * reduction);
    for (int y = 0; y < grey.height; ++y) {
        for (int x = 0; x < grey.width; ++x) {
            float sum = 0;
            for (int dy = 0; dy < reduction; ++dy) {
                const float* row = image.row(y * reduction + dy) + x * reduction;
                for (int dx = 0; dx < reduction; ++dx) sum += row[dx];
            }
            grey.value.push_back(sum * scale);
        }
    }
    return grey;
}

std::vector<std::uint8_t> stretched(const std::vector<float>& value) {
    std::vector<float> sorted;
    sorted.reserve(value.size());
    for (float v : value) {
        if (std::isfinite(v)) sorted.push_back(v);
    }
    float low = 0;
    float high = 0;
    if (!sorted.empty()) {
        const auto permille = static_cast<std::ptrdiff_t>(sorted.size() / 1000);
        std::nth_element(sorted.begin(), sorted.begin() + permille, sorted.end());
        low = sorted[static_cast<std::size_t>(permille)];
        std::nth_element(sorted.begin(), sorted.end() - 1 - permille, sorted.end());
        high = *(sorted.end() - 1 - permille);
    }
    const float gain = high > low ? 255 / (high - low) : 0;
    std::vector<std::uint8_t> grey(value.size());
    std::ranges::transform(value, grey.begin(), [&](float v) -> std::uint8_t {
        if (gain == 0 || !std::isfinite(v)) return 128;
        return static_cast<std::uint8_t>(std::lround(std::clamp((v - low) * gain, 0.0F, 255.0F)));
    });
    return grey;
}

void append(png_structp png, png_bytep data, png_size_t length) {
    auto* out = static_cast<std::vector<std::uint8_t>*>(png_get_io_ptr(png));
    out->insert(out->end(), data, data + length);
}

[[noreturn]] void fail(png_structp /*png*/, png_const_charp message) {
    throw OutputError(ErrorText{"cannot encode a preview image as PNG", message, "", ""});
}

void ignore(png_structp /*png*/, png_const_charp /*message*/) {}

/// Rows of 8-bit pixels of one or three channels. Camera noise hardly compresses: a higher level
/// costs three times the time for a few percent.
std::vector<std::uint8_t> encoded(std::span<const std::uint8_t> pixels, int width, int height,
                                  std::size_t channels, int level) {
    struct Writer {
        png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, fail, ignore);
        png_infop info = png_create_info_struct(png);
        ~Writer() { png_destroy_write_struct(&png, &info); }
    } writer;
    std::vector<std::uint8_t> out;
    png_set_write_fn(writer.png, &out, append, nullptr);
    png_set_IHDR(writer.png, writer.info, static_cast<png_uint_32>(width),
                 static_cast<png_uint_32>(height), 8,
                 channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_compression_level(writer.png, level);
    png_set_filter(writer.png, PNG_FILTER_TYPE_BASE, PNG_FILTER_UP);
    png_write_info(writer.png, writer.info);
    for (int y = 0; y < height; ++y) {
        const std::size_t start =
            static_cast<std::size_t>(y) * static_cast<std::size_t>(width) * channels;
        png_write_row(writer.png, pixels.data() + start);
    }
    png_write_end(writer.png, nullptr);
    return out;
}

}  // namespace

std::vector<std::uint8_t> encode_png(const Image& image, int reduction) {
    const Grey grey = reduced(image, reduction);
    return encoded(stretched(grey.value), grey.width, grey.height, 1, 4);
}

std::vector<std::uint8_t> encode_png(std::span<const std::uint8_t> rgb, int width, int height) {
    return encoded(rgb, width, height, 3, 1);
}

}  // namespace grainfield::report
