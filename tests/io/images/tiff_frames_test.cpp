#include "io/images/tiff_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;

TEST(TiffFrames, AreBitExactInEveryLayout) {
    const testing::ScratchFolder folder;
    const std::vector<TiffStyle> styles{
        {.depth = 8},
        {.depth = 16},
        {.depth = 16, .mode = "wb"},
        {.depth = 16, .mode = "w8"},
        {.depth = 16, .compression = COMPRESSION_LZW},
        {.depth = 16, .compression = COMPRESSION_ADOBE_DEFLATE},
        {.depth = 8, .samples = 3},
        {.depth = 16, .samples = 3, .planar = PLANARCONFIG_SEPARATE},
        {.depth = 16, .samples = 4, .compression = COMPRESSION_LZW},
        {.depth = 16, .tile = 32},
        {.depth = 8, .compression = COMPRESSION_LZW, .tile = 64},
    };
    for (std::size_t i = 0; i < styles.size(); ++i) {
        write_tiff(folder / "x.tif", 301, 257, styles[i]);
        const auto frames = open_tiff(folder / "x.tif", {});
        EXPECT_EQ(frames->bit_depth(), styles[i].depth);
        EXPECT_TRUE(holds_counts(frames->read(0).image, 301, 257, styles[i].depth)) << i;
    }
}

TEST(TiffFrames, OfMinIsWhiteAreInverted) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "x.tif", 20, 10, {.photometric = PHOTOMETRIC_MINISWHITE});
    const Frame frame = open_tiff(folder / "x.tif", {})->read(0);
    EXPECT_EQ(frame.image(7, 3), 255.0F - static_cast<float>(count_at(7, 3, 8)));
}

TEST(TiffFrames, ComeInAnyOrderAsOneAfterTheOther) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "x.tif", 40, 30, {.depth = 16, .pages = 50});
    const auto frames = open_tiff(folder / "x.tif", {.fps = 100});
    ASSERT_EQ(frames->count(), 50);
    for (const int i : {49, 0, 17, 18, 3}) {
        const Frame frame = frames->read(i);
        EXPECT_EQ(frame.index, i);
        EXPECT_DOUBLE_EQ(frame.time, i / 100.0);
        EXPECT_TRUE(holds_counts(frame.image, 40, 30, 16, i)) << i;
    }
    EXPECT_THROW(frames->read(50), OptionError);
    EXPECT_FALSE(open_tiff(folder / "x.tif", {})->frame_rate());
}

TEST(TiffFrames, OfACutFileKeepTheWholeOnesAndNeverCrash) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "x.tif", 40, 30, {.depth = 16, .pages = 5});
    const std::string whole = content_of(folder / "x.tif");
    std::int64_t most = 0;
    for (std::size_t n = 1; n < whole.size(); n += 61) {
        write_content(folder / "cut.tif", whole.substr(0, n));
        try {
            const auto frames = open_tiff(folder / "cut.tif", {});
            EXPECT_GE(frames->count(), most);
            EXPECT_FALSE(frames->warnings().empty()) << n;
            most = frames->count();
            for (std::int64_t i = 0; i < most; ++i) {
                const Frame frame = frames->read(i);
                if (frame.status == FrameStatus::ok) {
                    EXPECT_TRUE(holds_counts(frame.image, 40, 30, 16, static_cast<int>(i)));
                } else {
                    EXPECT_FALSE(frame.message.empty());
                }
            }
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), ::testing::HasSubstr("cut.tif"));
        }
    }
    EXPECT_EQ(most, 4);
}

TEST(TiffFrames, WithDamagedPixelsAreCorruptWithTheReason) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "x.tif", 64, 64, {.pages = 3, .compression = COMPRESSION_ADOBE_DEFLATE});
    std::string content = content_of(folder / "x.tif");
    const std::size_t third = content.size() / 2;
    for (std::size_t i = third; i < third + 60; ++i) content[i] = '\x5a';
    write_content(folder / "x.tif", content);
    const auto frames = open_tiff(folder / "x.tif", {});
    ASSERT_EQ(frames->count(), 3);
    EXPECT_EQ(frames->read(0).status, FrameStatus::ok);
    EXPECT_EQ(frames->read(1).status, FrameStatus::corrupt);
    EXPECT_FALSE(frames->read(1).message.empty());
    EXPECT_TRUE(frames->read(1).image.empty());
    EXPECT_EQ(frames->read(2).status, FrameStatus::ok);
}

TEST(TiffFrames, WithRandomBytesChangedNeverCrash) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "x.tif", 20, 10, {.depth = 16, .pages = 2});
    const std::string whole = content_of(folder / "x.tif");
    RandomStream random(1, "tiff damage");
    int opened = 0;
    for (int trial = 0; trial < 500; ++trial) {
        std::string damaged = whole;
        for (int i = 0; i < 3; ++i) {
            const auto at =
                static_cast<std::size_t>(random.uniform() * static_cast<double>(damaged.size()));
            damaged[at] = static_cast<char>(static_cast<int>(random.uniform() * 256) - 128);
        }
        write_content(folder / "d.tif", damaged);
        try {
            const auto frames = open_tiff(folder / "d.tif", {.fps = {}, .max_pixels = 10'000});
            for (std::int64_t i = 0; i < frames->count(); ++i) frames->read(i);
            ++opened;
        } catch (const InputError&) {
        }
    }
    EXPECT_GT(opened, 0);
}

TEST(TiffFrames, AboveThePixelCapOrOfAnotherKindAreRefused) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "x.tif", 100, 100, {});
    EXPECT_THROW(open_tiff(folder / "x.tif", {.fps = {}, .max_pixels = 9'999}), InputError);
    write_tiff(folder / "bits.tif", 16, 16, {.depth = 4});
    EXPECT_THROW(open_tiff(folder / "bits.tif", {}), InputError);
}

TEST(TiffFrames, OfChangingSizeAreRefusedWithTheirNumber) {
    const testing::ScratchFolder folder;
    TIFF* tiff = TIFFOpen((folder / "x.tif").c_str(), "w");
    write_page(tiff, 20, 10, {}, 0);
    write_page(tiff, 20, 11, {}, 1);
    TIFFClose(tiff);
    const auto frames = open_tiff(folder / "x.tif", {});
    try {
        frames->read(1);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("frame 1"));
        EXPECT_THAT(error.what(), ::testing::HasSubstr("20 × 11"));
    }
}

TEST(TiffFrames, OfTheRealCameraAreReadWhole) {
    const std::string path = GRAINFIELD_SOURCE_DIR "/../shared/data/vibrated_layer_frame.tif";
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no " << path;
    const auto frames = open_tiff(path, {});
    EXPECT_EQ(frames->count(), 1);
    EXPECT_EQ(frames->width(), 1012);
    EXPECT_EQ(frames->height(), 1012);
    EXPECT_EQ(frames->bit_depth(), 8);
    EXPECT_TRUE(frames->warnings().empty());
}

}  // namespace
}  // namespace grainfield::io
