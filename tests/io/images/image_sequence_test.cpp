#include "io/images/image_sequence.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/images/image_formats.h"
#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;
using ::testing::HasSubstr;

std::vector<std::filesystem::path> write_sequence(const testing::ScratchFolder& folder,
                                                  const std::vector<int>& numbers) {
    std::vector<std::filesystem::path> files;
    for (const int n : numbers) {
        files.emplace_back(folder / fmt::format("f{}.png", n));
        write_png(files.back(), 12, 8, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, n);
    }
    return files;
}

TEST(ImageSequence, ComesInNaturalOrderWithGapsAsMissingFrames) {
    const testing::ScratchFolder folder;
    const auto frames =
        open_image_sequence(write_sequence(folder, {10, 8, 12, 9}), {}, image_formats());
    ASSERT_EQ(frames->count(), 5);
    for (const int i : {0, 1, 2, 4}) {
        EXPECT_TRUE(holds_counts(frames->read(i).image, 12, 8, 8, 8 + i)) << i;
    }
    const Frame gap = frames->read(3);
    EXPECT_EQ(gap.status, FrameStatus::missing);
    EXPECT_EQ(gap.index, 3);
    EXPECT_FALSE(gap.message.empty());
    ASSERT_EQ(frames->warnings().size(), 1U);
    EXPECT_THAT(frames->warnings()[0], HasSubstr("f11.png"));
}

TEST(ImageSequence, FlagsADamagedImageAndGoesOn) {
    const testing::ScratchFolder folder;
    auto files = write_sequence(folder, {0, 1, 2});
    const std::string whole = content_of(files[1]);
    write_content(files[1], whole.substr(0, whole.size() / 2));
    const auto frames = open_image_sequence(files, {}, image_formats());
    EXPECT_EQ(frames->read(1).status, FrameStatus::corrupt);
    EXPECT_THAT(frames->read(1).message, HasSubstr("f1.png"));
    EXPECT_EQ(frames->read(2).status, FrameStatus::ok);
    EXPECT_THROW(open_image_sequence({files[1]}, {}, image_formats()), InputError);
}

TEST(ImageSequence, LooksAtLaterFilesOnlyWhenRead) {
    const testing::ScratchFolder folder;
    auto files = write_sequence(folder, {0, 1, 2});
    write_content(files[1], "this is text");
    const auto frames = open_image_sequence(files, {}, image_formats());
    EXPECT_EQ(frames->count(), 3);
    EXPECT_THROW(frames->read(1), InputError);
}

TEST(ImageSequence, RefusesAnotherSizeOrDepthWithTheFrameNumber) {
    const testing::ScratchFolder folder;
    auto files = write_sequence(folder, {0, 1, 2});
    write_png(files[1], 13, 8, 8, PNG_COLOR_TYPE_GRAY);
    write_png(files[2], 12, 8, 16, PNG_COLOR_TYPE_GRAY);
    const auto frames = open_image_sequence(files, {}, image_formats());
    for (const int i : {1, 2}) {
        try {
            frames->read(i);
            FAIL();
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), HasSubstr("frame " + std::to_string(i)));
            EXPECT_THAT(error.what(), HasSubstr(files[static_cast<std::size_t>(i)].string()));
        }
    }
}

TEST(ImageSequence, RefusesAMultiPageTiffAsOneOfSeveral) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "a1.tif", 10, 10, {});
    write_tiff(folder / "a2.tif", 10, 10, {.pages = 2});
    const auto frames =
        open_image_sequence({folder / "a1.tif", folder / "a2.tif"}, {}, image_formats());
    EXPECT_EQ(frames->read(0).status, FrameStatus::ok);
    EXPECT_THROW(frames->read(1), InputError);
}

}  // namespace
}  // namespace grainfield::io
