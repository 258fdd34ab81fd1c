#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <png.h>

#include "core/frame.h"

namespace grainfield::testing {

/// The counts of an 8-bit image, rounded and clipped.
inline std::vector<std::uint8_t> bytes_of(const Image& image) {
    std::vector<std::uint8_t> bytes;
    for (const float value : image.pixels()) {
        bytes.push_back(static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0F, 255.0F))));
    }
    return bytes;
}

/// 8-bit grey PNG.
inline void write_png(const std::string& path, const Image& image) {
    png_image header{};
    header.version = PNG_IMAGE_VERSION;
    header.width = static_cast<png_uint_32>(image.width());
    header.height = static_cast<png_uint_32>(image.height());
    header.format = PNG_FORMAT_GRAY;
    const auto bytes = bytes_of(image);
    if (png_image_write_to_file(&header, path.c_str(), 0, bytes.data(), 0, nullptr) == 0) {
        throw std::runtime_error("cannot write " + path);
    }
}

/// 8-bit grey TIFF: little-endian, not compressed, the directory before the single strip.
inline void write_tiff(const std::string& path, const Image& image) {
    std::ofstream file(path, std::ios::binary);
    const auto put = [&file](std::uint32_t value, unsigned bytes) {
        for (unsigned i = 0; i < bytes; ++i) {
            file.put(static_cast<char>((value >> (8 * i)) & 0xffU));
        }
    };
    constexpr std::uint32_t type_long = 4, strip_offset = 273;
    const auto width = static_cast<std::uint32_t>(image.width());
    const auto height = static_cast<std::uint32_t>(image.height());
    const std::vector<std::pair<std::uint32_t, std::uint32_t>> tags{
        {256, width}, {257, height}, {258, 8},
        {259, 1},     {262, 1},      {strip_offset, 0},
        {277, 1},     {278, height}, {279, width * height}};
    const std::uint32_t header_bytes = 8 + 2 + 12 * static_cast<std::uint32_t>(tags.size()) + 4;
    file << "II";
    put(42, 2);
    put(8, 4);
    put(static_cast<std::uint32_t>(tags.size()), 2);
    for (const auto& [tag, value] : tags) {
        put(tag, 2);
        put(type_long, 2);
        put(1, 4);
        put(tag == strip_offset ? header_bytes : value, 4);
    }
    put(0, 4);
    for (const std::uint8_t byte : bytes_of(image)) file.put(static_cast<char>(byte));
    if (!file) throw std::runtime_error("cannot write " + path);
}

/// Cuts a file to a fraction of its length.
inline void truncate_file(const std::string& path, double fraction) {
    const auto bytes = static_cast<double>(std::filesystem::file_size(path));
    std::filesystem::resize_file(path, static_cast<std::uintmax_t>(bytes * fraction));
}

}  // namespace grainfield::testing
