#include "io/images/coded_image.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;
constexpr std::int64_t cap = 1'000'000;

std::string pgm(int width, int height, int maximum) {
    std::string content = "P5\n# a comment 7 7 7\n" + std::to_string(width) + " " +
                          std::to_string(height) + "\n" + std::to_string(maximum) + "\n";
    const int depth = static_cast<int>(std::log2(maximum + 1));
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const unsigned count = count_at(x, y, depth);
            if (maximum > 255) content += static_cast<char>(count >> 8U);
            content += static_cast<char>(count & 255U);
        }
    }
    return content;
}

TEST(CodedImage, OfPgmKeepsItsCountsAtAnyMaximum) {
    const testing::ScratchFolder folder;
    for (const int depth : {8, 10, 12, 14, 16}) {
        write_content(folder / "x.pgm", pgm(151, 127, (1 << depth) - 1));
        const Picture picture = pnm_format().read(folder / "x.pgm", cap);
        EXPECT_EQ(picture.bit_depth, depth);
        EXPECT_TRUE(holds_counts(picture.image, 151, 127, depth)) << depth;
    }
}

TEST(CodedImage, CutAnywhereIsRefused) {
    const testing::ScratchFolder folder;
    const std::string whole = pgm(20, 10, 255);
    for (std::size_t n = 3; n < whole.size(); n += 5) {
        write_content(folder / "x.pgm", whole.substr(0, n));
        EXPECT_THROW(pnm_format().read(folder / "x.pgm", cap), InputError) << n;
    }
}

TEST(CodedImage, OfBmpAndJpegAreTheSamePictureAsTheirSource) {
    const testing::ScratchFolder folder;
    write_content(folder / "x.pgm", pgm(64, 48, 255));
    if (!ffmpeg("-i " + folder / "x.pgm" + " " + folder / "x.bmp" + " -q:v 1 -pix_fmt yuvj420p " +
                folder / "x.jpg")) {
        GTEST_SKIP() << "no ffmpeg program";
    }
    const Picture bmp = bmp_format().read(folder / "x.bmp", cap);
    EXPECT_TRUE(holds_counts(bmp.image, 64, 48, 8));
    const Picture jpeg = jpeg_format().read(folder / "x.jpg", cap);
    ASSERT_EQ(jpeg.shape(), bmp.shape());

    for (const char* name : {"x.bmp", "x.jpg"}) {
        const std::string whole = content_of(folder / name);
        const ImageFormat format = name == std::string("x.bmp") ? bmp_format() : jpeg_format();
        EXPECT_TRUE(format.recognises(whole)) << name;
        EXPECT_THROW(format.read(folder / name, 64 * 48 - 1), InputError);
        for (std::size_t n = 12; n + 3 < whole.size(); n += 1 + whole.size() / 50) {
            write_content(folder / "cut", whole.substr(0, n));
            EXPECT_THROW(format.read(folder / "cut", cap), InputError) << name << n;
        }
    }
}

}  // namespace
}  // namespace grainfield::io
