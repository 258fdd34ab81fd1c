#include "io/images/png_image.h"

#include <gtest/gtest.h>

#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;
constexpr std::int64_t cap = 1'000'000;

TEST(PngImage, IsReadBitExactAtBothDepths) {
    const testing::ScratchFolder folder;
    for (const int depth : {8, 16}) {
        for (const int colour : {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB,
                                 PNG_COLOR_TYPE_RGB_ALPHA}) {
            for (const int interlace : {PNG_INTERLACE_NONE, PNG_INTERLACE_ADAM7}) {
                write_png(folder / "x.png", 301, 257, depth, colour, interlace);
                const Picture picture = read_png(folder / "x.png", cap);
                EXPECT_EQ(picture.bit_depth, depth);
                EXPECT_TRUE(holds_counts(picture.image, 301, 257, depth)) << depth << colour;
            }
        }
    }
}

TEST(PngImage, CutAnywhereIsRefusedAndNeverCrashes) {
    const testing::ScratchFolder folder;
    write_png(folder / "x.png", 61, 47, 16, PNG_COLOR_TYPE_GRAY);
    const std::string whole = content_of(folder / "x.png");
    // The last 12 bytes are the end mark, whose own checksum libpng need not see.
    for (std::size_t n = 1; n + 12 < whole.size(); n += 1 + n / 40) {
        write_content(folder / "cut.png", whole.substr(0, n));
        EXPECT_THROW(read_png(folder / "cut.png", cap), CorruptPicture) << n;
    }
}

TEST(PngImage, AFlippedBitOfThePixelDataIsSeen) {
    const testing::ScratchFolder folder;
    write_png(folder / "x.png", 61, 47, 8, PNG_COLOR_TYPE_GRAY);
    const std::string whole = content_of(folder / "x.png");
    const std::size_t data = whole.find("IDAT") + 4;
    for (std::size_t at = data; at + 16 < whole.size(); at += 97) {
        std::string flipped = whole;
        flipped[at] = static_cast<char>(flipped[at] ^ 4);
        write_content(folder / "flipped.png", flipped);
        EXPECT_THROW(read_png(folder / "flipped.png", cap), CorruptPicture) << at;
    }
}

TEST(PngImage, AboveThePixelCapIsRefusedBeforeDecoding) {
    const testing::ScratchFolder folder;
    write_png(folder / "x.png", 100, 100, 8, PNG_COLOR_TYPE_GRAY);
    EXPECT_NO_THROW(read_png(folder / "x.png", 10'000));
    EXPECT_THROW(read_png(folder / "x.png", 9'999), InputError);
}

}  // namespace
}  // namespace grainfield::io
