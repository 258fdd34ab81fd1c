#include "io/images/image_formats.h"

#include <string>

#include <gtest/gtest.h>

namespace grainfield::io {
namespace {

std::string_view name_of(std::string_view head) {
    const ImageFormat* format = find_image_format(head, image_formats());
    return format == nullptr ? "none" : format->name;
}

TEST(ImageFormats, AreKnownByTheirFirstBytes) {
    EXPECT_EQ(name_of(std::string_view("II*\0abcd", 8)), "TIFF");
    EXPECT_EQ(name_of(std::string_view("MM\0+abcd", 8)), "TIFF");
    EXPECT_EQ(name_of("\x89PNG\r\n\x1a\n...."), "PNG");
    EXPECT_EQ(name_of("\xff\xd8\xff\xe0"), "JPEG");
    EXPECT_EQ(name_of(std::string_view("BM\x01\x02\x03\x04\0\0\0\0", 10)), "BMP");
    EXPECT_EQ(name_of("P5\n3 3 255"), "PNM");
    for (const char* text : {"BMW is a car, not a picture", "Plain text", "P7\n", ""}) {
        EXPECT_EQ(name_of(text), "none") << text;
    }
}

TEST(ImageFormats, ThatCanBeWrittenHaveAnExtension) {
    for (const ImageFormat& format : image_formats()) {
        EXPECT_EQ(format.write != nullptr, !format.extension.empty()) << format.name;
        EXPECT_EQ(find_image_format_named(format.name), &format);
    }
    EXPECT_EQ(find_image_format_named("GIF"), nullptr);
}

TEST(ImageFormats, AreNamedInMessages) {
    EXPECT_EQ(names_of(image_formats()), "PNG, TIFF, JPEG, BMP, PNM, Norpix seq or Phantom cine");
    EXPECT_EQ(names_of(image_formats().first(1)), "PNG");
    EXPECT_EQ(names_of({}), "");
}

}  // namespace
}  // namespace grainfield::io
