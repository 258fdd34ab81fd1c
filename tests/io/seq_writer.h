#pragma once

#include <cstdint>
#include <cstring>
#include <string>

#include "tests/io/picture_files.h"

namespace grainfield::io {

/// A writer of Norpix sequences of its own, from the description of the format.
struct SeqWriter {
    static constexpr int width = 20, height = 12;

    int version = 3;
    std::uint32_t stored_bits = 16, real_bits = 12, format = 100, compression = 0;
    double rate = 500;
    std::uint32_t declared = 4;
    std::uint32_t first_second = 1000;
    int step_us = 2000;  ///< between stamps
    int padding = 100;   ///< from the stamp to the next image

    std::string text(int frames) const {
        std::string out(version >= 5 ? 8192 : 1024, '\0');
        const auto put = [&](std::size_t at, std::uint32_t value) {
            for (unsigned i = 0; i < 4; ++i) {
                out[at + i] = static_cast<char>((value >> (8U * i)) & 255U);
            }
        };
        put(0, 0xfeed);
        const std::string title = "Norpix seq";
        for (std::size_t i = 0; i < title.size(); ++i) out[4 + 2 * i] = title[i];
        put(28, static_cast<std::uint32_t>(version));
        put(32, 1024);
        const std::uint32_t image = width * height * (stored_bits / 8);
        put(548, width);
        put(552, height);
        put(556, stored_bits);
        put(560, real_bits);
        put(564, image);
        put(568, format);
        put(572, declared);
        put(580, image + (version >= 5 ? 8 : 6) + static_cast<std::uint32_t>(padding));
        put(620, compression);
        std::memcpy(out.data() + 584, &rate, 8);
        for (int f = 0; f < frames; ++f) {
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    const unsigned count =
                        picture_files::count_at(x, y, static_cast<int>(real_bits), f);
                    out.push_back(static_cast<char>(count & 255U));
                    if (stored_bits == 16) out.push_back(static_cast<char>(count >> 8U));
                }
            }
            const int us = f * step_us;
            const std::uint32_t second = first_second + static_cast<std::uint32_t>(us / 1000000);
            for (unsigned i = 0; i < 4; ++i) {
                out.push_back(static_cast<char>((second >> (8U * i)) & 255U));
            }
            for (const int part : {us / 1000 % 1000, us % 1000}) {
                out.push_back(static_cast<char>(part & 255));
                out.push_back(static_cast<char>(part >> 8));
                if (version < 5) break;
            }
            out += std::string(static_cast<std::size_t>(padding), '\x7f');
        }
        return out;
    }
};

}  // namespace grainfield::io
