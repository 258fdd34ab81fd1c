#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <png.h>
#include <tiffio.h>

#include "core/frame.h"
#include "tests/support/program.h"

namespace grainfield::io::picture_files {

/// Every count of `depth` bits occurs if the picture is large enough; neighbours are unlike.
inline std::uint16_t count_at(int x, int y, int depth, int frame = 0) {
    const auto hash = static_cast<std::uint32_t>(x * 7919 + y * 104729 + frame * 1299709);
    return static_cast<std::uint16_t>(hash & ((1U << static_cast<unsigned>(depth)) - 1U));
}

inline bool holds_counts(const Image& image, int width, int height, int depth, int frame = 0) {
    if (image.width() != width || image.height() != height) return false;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            if (image(x, y) != static_cast<float>(count_at(x, y, depth, frame))) return false;
        }
    }
    return true;
}

/// `samples` counts a pixel, all equal; 16-bit words in the order of the machine.
inline std::vector<std::uint8_t> row_bytes(int width, int y, int depth, int frame, int samples) {
    std::vector<std::uint8_t> row;
    for (int i = 0; i < width * samples; ++i) {
        const unsigned count = count_at(i / samples, y, depth, frame);
        row.push_back(static_cast<std::uint8_t>(count & 255U));
        if (depth == 16) row.push_back(static_cast<std::uint8_t>(count >> 8U));
    }
    return row;
}

/// The lowest `bits` of a count, highest first, one character a bit.
inline std::string bits_of(unsigned count, int bits) {
    std::string out;
    for (int bit = bits - 1; bit >= 0; --bit) {
        out += (count >> static_cast<unsigned>(bit) & 1U) != 0 ? '1' : '0';
    }
    return out;
}

/// Such bits as bytes, zeros behind the last ones.
inline std::string packed(std::string bits) {
    while (bits.size() % 8 != 0) bits += '0';
    std::string out;
    for (std::size_t i = 0; i < bits.size(); i += 8) {
        out += static_cast<char>(std::stoi(bits.substr(i, 8), nullptr, 2));
    }
    return out;
}

struct TiffStyle {
    int depth = 8;
    int samples = 1;
    int pages = 1;
    std::uint16_t compression = COMPRESSION_NONE;
    std::uint16_t planar = PLANARCONFIG_CONTIG;
    const char* mode = "w";  ///< "wb": big-endian
    int tile = 0;
    std::uint16_t photometric = PHOTOMETRIC_MINISBLACK;
    std::string description{};  ///< of the first page
};

inline void write_page(TIFF* tiff, int width, int height, const TiffStyle& style, int page) {
    const auto side = [](int n) { return static_cast<std::uint32_t>(n); };
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, side(width));
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, side(height));
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, style.depth);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, style.samples);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
                 style.samples >= 3 ? PHOTOMETRIC_RGB : style.photometric);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, style.compression);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, style.planar);
    if (page == 0 && !style.description.empty()) {
        TIFFSetField(tiff, TIFFTAG_IMAGEDESCRIPTION, style.description.c_str());
    }
    if (style.tile > 0) {
        TIFFSetField(tiff, TIFFTAG_TILEWIDTH, side(style.tile));
        TIFFSetField(tiff, TIFFTAG_TILELENGTH, side(style.tile));
        for (int y0 = 0; y0 < height; y0 += style.tile) {
            for (int x0 = 0; x0 < width; x0 += style.tile) {
                std::vector<std::uint8_t> tile;
                for (int y = y0; y < y0 + style.tile; ++y) {
                    const auto row = row_bytes(x0 + style.tile, y, style.depth, page, 1);
                    tile.insert(tile.end(), row.begin() + x0 * style.depth / 8, row.end());
                }
                TIFFWriteTile(tiff, tile.data(), side(x0), side(y0), 0, 0);
            }
        }
    } else {
        TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, 7);
        const bool separate = style.planar == PLANARCONFIG_SEPARATE;
        for (int plane = 0; plane < (separate ? style.samples : 1); ++plane) {
            for (int y = 0; y < height; ++y) {
                auto row = row_bytes(width, y, style.depth, page, separate ? 1 : style.samples);
                TIFFWriteScanline(tiff, row.data(), side(y), static_cast<std::uint16_t>(plane));
            }
        }
    }
    TIFFWriteDirectory(tiff);
}

inline void write_tiff(const std::string& path, int width, int height, const TiffStyle& style) {
    TIFF* tiff = TIFFOpen(path.c_str(), style.mode);
    if (tiff == nullptr) throw std::runtime_error("cannot write " + path);
    for (int page = 0; page < style.pages; ++page) write_page(tiff, width, height, style, page);
    TIFFClose(tiff);
}

inline void write_png(const std::string& path, int width, int height, int depth, int color_type,
                      int interlace = PNG_INTERLACE_NONE, int frame = 0) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, static_cast<png_uint_32>(width), static_cast<png_uint_32>(height),
                 depth, color_type, interlace, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    if (depth == 16) png_set_swap(png);
    const int samples = png_get_channels(png, info);
    std::vector<std::vector<std::uint8_t>> rows;
    std::vector<png_bytep> pointers;
    for (int y = 0; y < height; ++y) rows.push_back(row_bytes(width, y, depth, frame, samples));
    for (auto& row : rows) pointers.push_back(row.data());
    png_write_image(png, pointers.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
}

inline std::string content_of(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

inline void write_content(const std::string& path, const std::string& content) {
    std::ofstream(path, std::ios::binary) << content;
}

/// Runs the ffmpeg program; false if it is absent or fails.
inline bool ffmpeg(const std::string& arguments) {
    return testing::shell("ffmpeg -hide_banner -nostdin -y " + arguments).code == 0;
}

}  // namespace grainfield::io::picture_files
