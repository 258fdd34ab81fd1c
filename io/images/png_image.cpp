#include "io/images/png_image.h"

#include <csetjmp>
#include <cstdio>
#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include <png.h>

#include "io/input_file.h"

namespace grainfield::io {

namespace {

struct FileCloser {
    void operator()(std::FILE* file) const { std::fclose(file); }
};

/// State of one decoding. libpng leaves by longjmp, which skips destructors: whatever owns memory
/// lives here, and the functions below that call libpng have only plain local variables.
struct PngReader {
    std::unique_ptr<std::FILE, FileCloser> file;
    png_structp png = nullptr;
    png_infop info = nullptr;
    std::string message;
    png_uint_32 width = 0;
    png_uint_32 height = 0;
    int bit_depth = 0;
    int channels = 0;
    std::size_t row_bytes = 0;
    std::vector<png_byte> pixels;
    std::vector<png_bytep> rows;

    PngReader() = default;
    PngReader(const PngReader&) = delete;
    PngReader& operator=(const PngReader&) = delete;
    ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }
};

[[noreturn]] void on_error(png_structp png, png_const_charp text) {
    static_cast<PngReader*>(png_get_error_ptr(png))->message = text;
    png_longjmp(png, 1);
}

void on_warning(png_structp, png_const_charp) {}

bool start(PngReader& reader) {
    reader.png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &reader, on_error, on_warning);
    if (reader.png == nullptr) return false;
    reader.info = png_create_info_struct(reader.png);
    return reader.info != nullptr;
}

bool read_header(PngReader& reader) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_init_io(reader.png, reader.file.get());
    // Sizes are checked by the caller, with its own limit.
    png_set_user_limits(reader.png, PNG_UINT_31_MAX, PNG_UINT_31_MAX);
    png_read_info(reader.png, reader.info);
    reader.width = png_get_image_width(reader.png, reader.info);
    reader.height = png_get_image_height(reader.png, reader.info);
    reader.bit_depth = png_get_bit_depth(reader.png, reader.info);
    if (png_get_color_type(reader.png, reader.info) == PNG_COLOR_TYPE_PALETTE) {
        png_set_palette_to_rgb(reader.png);
        reader.bit_depth = 8;
    }
    png_set_packing(reader.png);
    if (reader.bit_depth == 16) png_set_swap(reader.png);
    static_cast<void>(png_set_interlace_handling(reader.png));
    png_read_update_info(reader.png, reader.info);
    reader.channels = png_get_channels(reader.png, reader.info);
    reader.row_bytes = png_get_rowbytes(reader.png, reader.info);
    return true;
}

bool read_pixels(PngReader& reader) {
    if (setjmp(png_jmpbuf(reader.png))) return false;
    png_read_image(reader.png, reader.rows.data());
    // The checksum of the last piece of pixel data is looked at only here.
    png_read_end(reader.png, nullptr);
    return true;
}

template <class Sample>
void convert_row(const png_byte* bytes, int channels, int width, float* out) {
    const auto sample = [bytes](int i) {
        Sample value;
        std::memcpy(&value, bytes + static_cast<std::size_t>(i) * sizeof(Sample), sizeof(Sample));
        return value;
    };
    if (channels < 3) {
        for (int x = 0; x < width; ++x) out[x] = static_cast<float>(sample(x * channels));
        return;
    }
    for (int x = 0; x < width; ++x) {
        const int i = x * channels;
        out[x] = luma(sample(i), sample(i + 1), sample(i + 2));
    }
}

bool is_png(std::string_view head) {
    return head.starts_with("\x89PNG\r\n\x1a\n");
}

void write_png(const std::filesystem::path& path, std::span<const std::uint8_t> counts,
               const PictureShape& shape) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(shape.width);
    header.height = static_cast<png_uint_32>(shape.height);
    header.format = shape.bit_depth > 8 ? PNG_FORMAT_LINEAR_Y : PNG_FORMAT_GRAY;
    header.flags = PNG_IMAGE_FLAG_FAST;
    if (png_image_write_to_file(&header, path.c_str(), 0, counts.data(), 0, nullptr) == 0) {
        fail_to_write(path, header.message);
    }
}

}  // namespace

Picture read_png(const std::filesystem::path& path, std::int64_t max_pixels) {
    require_input_file(path);
    PngReader reader;
    reader.file.reset(std::fopen(path.c_str(), "rb"));
    if (!reader.file) read_head(path, 1);  // throws with the reason
    if (!start(reader)) throw std::bad_alloc();
    if (!read_header(reader)) throw CorruptPicture(path, "libpng: " + reader.message);
    require_pixel_count(path, reader.width, reader.height, max_pixels);

    const std::size_t height = reader.height;
    reader.pixels.resize(reader.row_bytes * height);
    reader.rows.resize(height);
    for (std::size_t y = 0; y < height; ++y) {
        reader.rows[y] = reader.pixels.data() + y * reader.row_bytes;
    }
    if (!read_pixels(reader)) throw CorruptPicture(path, "libpng: " + reader.message);

    Picture picture{Image(static_cast<int>(reader.width), static_cast<int>(reader.height)),
                    reader.bit_depth};
    for (std::size_t y = 0; y < height; ++y) {
        float* out = picture.image.row(static_cast<int>(y));
        const auto convert =
            reader.bit_depth == 16 ? convert_row<std::uint16_t> : convert_row<std::uint8_t>;
        convert(reader.rows[y], reader.channels, picture.image.width(), out);
    }
    return picture;
}

ImageFormat png_format() {
    return {.name = "PNG",
            .recognises = is_png,
            .read = read_png,
            .extension = "png",
            .write = write_png};
}

}  // namespace grainfield::io
