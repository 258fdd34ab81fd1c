#include "io/frame_files.h"

#include <chrono>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;
using ::testing::HasSubstr;

std::string refusal(const std::vector<std::filesystem::path>& inputs) {
    try {
        open_frames(inputs, {});
    } catch (const InputError& error) {
        return error.what();
    }
    return "not refused";
}

TEST(FrameFiles, RefuseBadInputsByName) {
    const testing::ScratchFolder folder;
    write_content(folder / "empty.tif", "");
    write_content(folder / "text.tif", "these are my notes\n");
    write_content(folder / "text.avi", "these are my notes\n");
    EXPECT_THAT(refusal({folder / "absent.tif"}), HasSubstr("absent.tif"));
    EXPECT_THAT(refusal({folder / "empty.tif"}), HasSubstr("empty"));
    EXPECT_THAT(refusal({folder.path()}), HasSubstr("*.tif"));
    EXPECT_THAT(refusal({folder / "text.tif"}), HasSubstr("these are my not"));
    EXPECT_THAT(refusal({folder / "text.tif"}), HasSubstr("text.tif"));
    EXPECT_THAT(refusal({folder / "text.avi"}), HasSubstr("text.avi"));
    EXPECT_THAT(refusal({}), HasSubstr("no input"));
}

TEST(FrameFiles, OpenEachKindByContentNotByName) {
    const testing::ScratchFolder folder;
    write_png(folder / "really-png.tif", 12, 8, 16, PNG_COLOR_TYPE_GRAY);
    const auto png = open_frames({folder / "really-png.tif"}, {});
    EXPECT_EQ(png->bit_depth(), 16);
    write_tiff(folder / "really-tiff.png", 12, 8, {.pages = 3});
    EXPECT_EQ(open_frames({folder / "really-tiff.png"}, {})->count(), 3);
    if (!ffmpeg("-f lavfi -i testsrc=s=32x16:r=10:d=1 -pix_fmt gray -c:v ffv1 " +
                folder / "v.mkv")) {
        GTEST_SKIP() << "no ffmpeg program";
    }
    EXPECT_EQ(open_frames({folder / "v.mkv"}, {})->count(), 10);
    EXPECT_THAT(refusal({folder / "v.mkv", folder / "really-png.tif"}), HasSubstr("video"));
}

TEST(FrameFiles, OfThreeThousandImagesOpenWithoutDecodingThem) {
    const testing::ScratchFolder folder;
    write_png(folder / "i0.png", 400, 400, 16, PNG_COLOR_TYPE_GRAY);
    std::vector<std::filesystem::path> files{folder / "i0.png"};
    for (int i = 1; i < 3000; ++i) {
        files.emplace_back(folder / fmt::format("i{}.png", i));
        std::filesystem::create_hard_link(files[0], files.back());
    }
    const auto start = std::chrono::steady_clock::now();
    EXPECT_EQ(open_frames(files, {})->count(), 3000);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    EXPECT_LT(seconds.count(), 2);  // decoding all takes about 10 s
}

TEST(FrameFiles, RefuseUnusableOptions) {
    const testing::ScratchFolder folder;
    write_png(folder / "x.png", 12, 8, 8, PNG_COLOR_TYPE_GRAY);
    for (const double fps : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        EXPECT_THROW(open_frames({folder / "x.png"}, {.fps = fps}), OptionError);
    }
    EXPECT_THROW(open_frames({folder / "x.png"}, {.fps = {}, .max_pixels = 0}), OptionError);
    EXPECT_EQ(open_frames({folder / "x.png"}, {.fps = 7})->frame_rate(), 7);
    EXPECT_FALSE(open_frames({folder / "x.png"}, {})->frame_rate());
}

}  // namespace
}  // namespace grainfield::io
