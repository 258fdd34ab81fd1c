#include "report/figures/colours.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace grainfield::report {

namespace {

constexpr std::array<Colour, 11> viridis_anchors{{{0x44, 0x01, 0x54},
                                                  {0x48, 0x24, 0x75},
                                                  {0x41, 0x44, 0x87},
                                                  {0x35, 0x5f, 0x8d},
                                                  {0x2a, 0x78, 0x8e},
                                                  {0x21, 0x91, 0x8c},
                                                  {0x22, 0xa8, 0x84},
                                                  {0x44, 0xbf, 0x70},
                                                  {0x7a, 0xd1, 0x51},
                                                  {0xbd, 0xdf, 0x26},
                                                  {0xfd, 0xe7, 0x25}}};

constexpr std::array<Colour, 7> palette{{{0x00, 0x72, 0xb2},
                                         {0xd5, 0x5e, 0x00},
                                         {0x00, 0x9e, 0x73},
                                         {0xcc, 0x79, 0xa7},
                                         {0xe6, 0x9f, 0x00},
                                         {0x56, 0xb4, 0xe9},
                                         {0x00, 0x00, 0x00}}};

}  // namespace

Colour viridis(double t) {
    if (std::isnan(t)) return {0x99, 0x99, 0x99};
    const double place = std::clamp(t, 0.0, 1.0) * (viridis_anchors.size() - 1);
    const auto low = std::min(static_cast<std::size_t>(place), viridis_anchors.size() - 2);
    const double part = place - static_cast<double>(low);
    Colour colour{};
    for (std::size_t c = 0; c < 3; ++c) {
        const double value =
            (1 - part) * viridis_anchors[low][c] + part * viridis_anchors[low + 1][c];
        colour[c] = static_cast<std::uint8_t>(std::lround(value));
    }
    return colour;
}

Colour distinct_colour(std::size_t index, std::size_t count) {
    if (count <= palette.size()) return palette[index % palette.size()];
    return viridis(0.88 * static_cast<double>(index) / static_cast<double>(count - 1));
}

std::string hex(Colour colour) {
    return fmt::format("#{:02x}{:02x}{:02x}", colour[0], colour[1], colour[2]);
}

}  // namespace grainfield::report
