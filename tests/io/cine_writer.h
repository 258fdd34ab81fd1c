#pragma once

#include <cstdint>
#include <string>

#include "tests/io/picture_files.h"

namespace grainfield::io {

/// A writer of Phantom recordings of its own, from the description of the format.
struct CineWriter {
    static constexpr int width = 20, height = 12;
    static constexpr std::size_t bitmap_at = 44, setup_at = 84, setup_length = 0x163c;
    static constexpr std::size_t times_at = setup_at + setup_length;

    int version = 1;  ///< 0: places of the images in 4 bytes, not 8
    int kind = 0;     ///< 0 grey or colours, 1 JPEG, 2 raw of a colour filter
    int bits = 16, real_bits = 12;
    int packing = 0;
    std::uint32_t filter = 0, rate = 500, declared = 4;
    int note = 8;             ///< bytes before the pixels
    int step_us = 2000;       ///< between stamps; 0: no stamps
    bool is_upright = false;  ///< negative height: the highest row first

    std::size_t block_bytes(int frames) const {
        return step_us == 0 ? 0 : 8 + 8 * static_cast<std::size_t>(frames);
    }
    std::size_t table_at(int frames) const { return times_at + 12 + block_bytes(frames); }
    std::size_t place_bytes() const { return version == 0 ? 4 : 8; }
    std::size_t image_bytes() const {
        return static_cast<std::size_t>(width * height * bits_a_pixel() + 7) / 8;
    }
    std::size_t place(int frame, int frames) const {
        return table_at(frames) + place_bytes() * static_cast<std::size_t>(frames) +
               static_cast<std::size_t>(frame) * (image_bytes() + static_cast<std::size_t>(note));
    }

    std::string text(int frames) const {
        std::string out(table_at(frames), '\0');
        put(out, 0, 0x4943, 2);
        put(out, 2, 44, 2);
        put(out, 4, static_cast<std::uint64_t>(kind), 2);
        put(out, 6, static_cast<std::uint64_t>(version), 2);
        put(out, 20, declared, 4);
        put(out, 24, bitmap_at, 4);
        put(out, 28, setup_at, 4);
        put(out, 32, table_at(frames), 4);
        put(out, bitmap_at, 40, 4);
        put(out, bitmap_at + 4, width, 4);
        put(out, bitmap_at + 8, static_cast<std::uint32_t>(is_upright ? -height : height), 4);
        put(out, bitmap_at + 12, 1, 2);
        put(out, bitmap_at + 14, static_cast<std::uint64_t>(packing == 0 ? bits : 16), 2);
        put(out, bitmap_at + 16, static_cast<std::uint64_t>(packing), 4);
        put(out, setup_at, rate & 0xffffU, 2);
        put(out, setup_at + 140, 0x5453, 2);
        put(out, setup_at + 142, setup_length, 2);
        put(out, setup_at + 768, rate, 4);
        put(out, setup_at + 808, filter, 4);
        put(out, setup_at + 896, static_cast<std::uint64_t>(real_bits), 4);
        // A block that nobody needs, then the times.
        put(out, times_at, 12, 4);
        put(out, times_at + 4, 1007, 2);
        if (step_us > 0) {
            put(out, times_at + 12, block_bytes(frames), 4);
            put(out, times_at + 16, 1002, 2);
        }
        for (int f = 0; f < frames; ++f) {
            if (step_us > 0) {
                const double second = 1e-6 * step_us * f;
                const auto fraction =
                    static_cast<std::uint64_t>((second - static_cast<int>(second)) * 4294967296.0);
                const std::size_t at = times_at + 20 + 8 * static_cast<std::size_t>(f);
                put(out, at, fraction | 3U, 4);  // two bits are no time
                put(out, at + 4, 1000U + static_cast<unsigned>(second), 4);
            }
            append(out, place(f, frames), static_cast<unsigned>(place_bytes()));
        }
        for (int f = 0; f < frames; ++f) {
            append(out, static_cast<std::uint64_t>(note), 4);
            out += std::string(static_cast<std::size_t>(note - 8), '\x55');
            append(out, image_bytes(), 4);
            append_pixels(out, f);
        }
        return out;
    }

 private:
    int bits_a_pixel() const { return packing == 0x100 ? 10 : packing == 0x400 ? 12 : bits; }

    static void put(std::string& out, std::size_t at, std::uint64_t value, unsigned bytes) {
        for (unsigned i = 0; i < bytes; ++i) {
            out[at + i] = static_cast<char>(value >> (8U * i) & 255U);
        }
    }
    static void append(std::string& out, std::uint64_t value, unsigned bytes) {
        out.resize(out.size() + bytes);
        put(out, out.size() - bytes, value, bytes);
    }

    void append_pixels(std::string& out, int frame) const {
        std::string bits_in_a_row;
        for (int row = 0; row < height; ++row) {
            const int y = packing != 0 || is_upright ? row : height - 1 - row;
            for (int x = 0; x < width; ++x) {
                const unsigned count = picture_files::count_at(x, y, real_bits, frame);
                if (packing == 0) {
                    const int samples = bits % 3 == 0 ? 3 : 1;
                    for (int i = 0; i < samples; ++i) {
                        append(out, count, static_cast<unsigned>(bits / samples / 8));
                    }
                    continue;
                }
                bits_in_a_row += picture_files::bits_of(count, bits_a_pixel());
            }
        }
        out += picture_files::packed(bits_in_a_row);
    }
};

}  // namespace grainfield::io
