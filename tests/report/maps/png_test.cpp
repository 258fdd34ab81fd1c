#include "report/maps/png.h"

#include <cmath>

#include <gtest/gtest.h>
#include <png.h>

#include "core/support/random.h"

namespace grainfield::report {
namespace {

struct Decoded {
    unsigned width = 0;
    unsigned height = 0;
    std::vector<std::uint8_t> grey;
};

Decoded decode(const std::vector<std::uint8_t>& bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    EXPECT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
    image.format = PNG_FORMAT_GRAY;
    Decoded decoded{image.width, image.height, {}};
    decoded.grey.resize(PNG_IMAGE_SIZE(image));
    EXPECT_TRUE(png_image_finish_read(&image, nullptr, decoded.grey.data(), 0, nullptr));
    return decoded;
}

TEST(EncodePng, StretchesCountsLinearly) {
    Image image(16, 16);
    for (int i = 0; i < 256; ++i) image(i % 16, i / 16) = static_cast<float>(1000 + 10 * i);
    const Decoded decoded = decode(encode_png(image, 1));
    ASSERT_EQ(decoded.width, 16U);
    ASSERT_EQ(decoded.height, 16U);
    for (int i = 0; i < 256; ++i) {
        EXPECT_EQ(decoded.grey[static_cast<std::size_t>(i)], i);
    }
}

TEST(EncodePng, IgnoresAPermilleOfOutliers) {
    Image image(100, 100, 50);
    for (int x = 0; x < 100; ++x) image(x, 10) = 150;
    for (int i = 0; i < 10; ++i) image(i, 0) = 1e6F;
    const Decoded decoded = decode(encode_png(image, 1));
    EXPECT_EQ(decoded.grey[10 * 100], 255);
    EXPECT_EQ(decoded.grey[50 * 100], 0);
}

TEST(EncodePng, KeepsColours) {
    std::vector<std::uint8_t> rgb;
    for (int i = 0; i < 3 * 7 * 5; ++i) rgb.push_back(static_cast<std::uint8_t>(37 * i % 256));
    const std::vector<std::uint8_t> bytes = encode_png(rgb, 7, 5);
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    ASSERT_TRUE(png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()));
    image.format = PNG_FORMAT_RGB;
    EXPECT_EQ(image.width, 7U);
    EXPECT_EQ(image.height, 5U);
    std::vector<std::uint8_t> decoded(PNG_IMAGE_SIZE(image));
    ASSERT_TRUE(png_image_finish_read(&image, nullptr, decoded.data(), 0, nullptr));
    EXPECT_EQ(decoded, rgb);
}

TEST(EncodePng, AveragesSquares) {
    Image image(5, 4);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 5; ++x) image(x, y) = x < 2 ? 10.0F : (y % 2 == 0 ? 20.0F : 40.0F);
    }
    const Decoded decoded = decode(encode_png(image, 2));
    ASSERT_EQ(decoded.width, 2U);
    ASSERT_EQ(decoded.height, 2U);
    EXPECT_EQ(decoded.grey, (std::vector<std::uint8_t>{0, 255, 0, 255}));
}

TEST(EncodePng, OfAUniformOrBrokenImageIsGrey) {
    for (float value : {0.0F, 255.0F, std::nanf("")}) {
        const Decoded decoded = decode(encode_png(Image(8, 8, value), 1));
        for (std::uint8_t grey : decoded.grey) EXPECT_EQ(grey, 128);
    }
}

}  // namespace
}  // namespace grainfield::report
