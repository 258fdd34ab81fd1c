#include "io/colour_filter.h"

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::io {
namespace {

/// Light of three colours on a sensor: red falls to the right, green downwards, blue is even.
float light(char colour, int x, int y) {
    switch (colour) {
        case 'r':
            return 1000.0F + 8.0F * static_cast<float>(x);
        case 'g':
            return 500.0F + 4.0F * static_cast<float>(y);
        default:
            return 200;
    }
}

/// What the sensor sees behind a filter named by its first two rows, as its makers write it.
Image behind(const std::string& filter, int width, int height) {
    Image mosaic(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            mosaic(x, y) = light(filter[static_cast<std::size_t>(2 * (y % 2) + x % 2)], x, y);
        }
    }
    return mosaic;
}

const std::map<std::string, ColourFilter> filters{{"rggb", ColourFilter::rggb},
                                                  {"grbg", ColourFilter::grbg},
                                                  {"gbrg", ColourFilter::gbrg},
                                                  {"bggr", ColourFilter::bggr}};

// A plane is its own interpolation: every channel comes back, but for rounding and the rim.
TEST(ColourFilter, EveryColourComesBackFromEveryFilter) {
    for (const auto& [name, filter] : filters) {
        const Image mosaic = behind(name, 24, 20);
        const std::array<std::pair<MosaicChannel, char>, 3> channels{
            {{MosaicChannel::red, 'r'}, {MosaicChannel::green, 'g'}, {MosaicChannel::blue, 'b'}}};
        for (const auto& [channel, colour] : channels) {
            const Image made = demosaiced(mosaic, filter, channel);
            for (int y = 2; y < 18; ++y) {
                for (int x = 2; x < 22; ++x) {
                    ASSERT_NEAR(made(x, y), light(colour, x, y), 1)
                        << name << ", " << colour << " at " << x << ", " << y;
                }
            }
        }
        const Image grey = demosaiced(mosaic, filter, MosaicChannel::grey);
        for (int x = 2; x < 22; ++x) {
            const float luma =
                0.299F * light('r', x, 9) + 0.587F * light('g', x, 9) + 0.114F * light('b', x, 9);
            ASSERT_NEAR(grey(x, 9), luma, 1.5) << name;
        }
    }
}

TEST(ColourFilter, ContrastIsThatOfEachColour) {
    for (const auto& [name, filter] : filters) {
        const std::array<double, 3> contrast = contrasts_of(behind(name, 100, 100), filter);
        EXPECT_NEAR(contrast[0], 0.96 * 8 * 98, 20) << name;
        EXPECT_NEAR(contrast[1], 0.96 * 4 * 99, 20) << name;
        EXPECT_EQ(contrast[2], 0) << name;
    }
}

TEST(ColourFilter, KeepsSixteenBits) {
    Image mosaic(8, 8, 65535);
    EXPECT_EQ(demosaiced(mosaic, ColourFilter::rggb, MosaicChannel::green), mosaic);
    EXPECT_EQ(demosaiced(mosaic, ColourFilter::none, MosaicChannel::green), mosaic);
    EXPECT_THROW(demosaiced(Image(2, 2), ColourFilter::rggb, MosaicChannel::grey), InputError);
}

}  // namespace
}  // namespace grainfield::io
