// Follows the steps of "Add an image format" in CONTRIBUTING.md with a toy format: a text of
// counts.
#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/frame_files.h"
#include "io/input_file.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

// Step 1, toy_image.cpp: recognise, read, write.
bool is_toy(std::string_view head) {
    return head.starts_with("TOY ");
}

Picture read_toy(const std::filesystem::path& path, std::int64_t max_pixels) {
    std::istringstream content(read_content(path, 1 << 20));
    std::string magic;
    int width = 0, height = 0;
    if (!(content >> magic >> width >> height)) throw CorruptPicture(path, "no size");
    require_pixel_count(path, width, height, max_pixels);
    Picture picture{Image(width, height), 8};
    for (float& pixel : picture.image.pixels()) {
        if (!(content >> pixel)) throw CorruptPicture(path, "it ends too early");
    }
    return picture;
}

void write_toy(const std::filesystem::path& path, std::span<const std::uint8_t> counts,
               const PictureShape& shape) {
    std::ofstream file(path);
    file << "TOY " << shape.width << ' ' << shape.height;
    for (const int count : counts) file << ' ' << count;
    if (!file.flush()) fail_to_write(path, "it is cut short");
}

// Step 1, toy_image.h.
ImageFormat toy_format() {
    return {.name = "TOY",
            .recognises = is_toy,
            .read = read_toy,
            .extension = "toy",
            .write = write_toy};
}

// Step 2, one line of image_formats.cpp.
std::vector<ImageFormat> formats_with_toy() {
    std::vector<ImageFormat> formats(image_formats().begin(), image_formats().end());
    formats.push_back(toy_format());
    return formats;
}

class AddAFormat : public ::testing::Test {
 protected:
    std::vector<std::filesystem::path> write_frames(const ImageFormat& format, int frames) {
        const auto writer = make_frame_writer(
            folder_ / "frames",
            {.format = &format, .width = 4, .height = 3, .bit_depth = 8, .fps = {}},
            Overwrite::refuse);
        std::vector<std::filesystem::path> files;
        for (int i = 0; i < frames; ++i) {
            writer->write(frame(i));
            files.emplace_back(folder_ / fmt_name(i));
        }
        writer->finish();
        return files;
    }
    static std::string fmt_name(int i) { return "frames/frame-00000" + std::to_string(i) + ".toy"; }
    static Frame frame(int index) {
        Frame frame;
        frame.index = index;
        frame.image = Image(4, 3, static_cast<float>(10 + index));
        frame.image(2, 1) = 200;
        return frame;
    }

    testing::ScratchFolder folder_;
    std::vector<ImageFormat> formats_ = formats_with_toy();
};

TEST_F(AddAFormat, FramesThatAreWrittenAreReadBack) {
    const auto frames = open_frames(write_frames(toy_format(), 3), {}, formats_);
    ASSERT_EQ(frames->count(), 3);
    EXPECT_EQ(frames->bit_depth(), 8);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(frames->read(i).image, frame(i).image) << i;
}

TEST_F(AddAFormat, ADamagedPictureIsACorruptFrame) {
    const auto files = write_frames(toy_format(), 2);
    std::ofstream(files[1]) << "TOY 4 3 1 2";
    const auto frames = open_frames(files, {}, formats_);
    EXPECT_EQ(frames->read(0).status, FrameStatus::ok);
    const Frame damaged = frames->read(1);
    EXPECT_EQ(damaged.status, FrameStatus::corrupt);
    EXPECT_NE(damaged.message.find("it ends too early"), std::string::npos) << damaged.message;
}

TEST_F(AddAFormat, OnlyTheRegistryMakesAFileAnImage) {
    const auto files = write_frames(toy_format(), 2);
    EXPECT_THROW(open_frames(files, {}), InputError);
    ImageFormat only_read = toy_format();
    only_read.write = nullptr;
    EXPECT_THROW(write_frames(only_read, 1), OptionError);
}

}  // namespace
}  // namespace grainfield::io
