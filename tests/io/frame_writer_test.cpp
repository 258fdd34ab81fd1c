#include "io/frame_writer.h"

#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/frame_files.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

Frame frame_of(int index, int bits, int width = 67, int height = 45) {
    Frame frame;
    frame.index = index;
    frame.bit_depth = bits;
    frame.image = Image(width, height);
    const unsigned top = (1U << static_cast<unsigned>(bits)) - 1U;
    unsigned value = static_cast<unsigned>(index) * 977U + 1U;
    for (float& pixel : frame.image.pixels()) {
        value = value * 1664525U + 1013904223U;
        pixel = static_cast<float>((value >> 8U) & top);
    }
    frame.image.pixels().front() = 0;
    frame.image.pixels().back() = static_cast<float>(top);
    return frame;
}

std::string content(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

TEST(FrameWriter, VideosGiveBackEveryCountAndTheFrameRate) {
    const testing::ScratchFolder folder;
    for (const char* name : {"x.avi", "x.mkv"}) {
        for (const int bits : {8, 10, 12, 16}) {
            const std::string path = folder / name;
            const auto writer = make_frame_writer(
                path, {.width = 67, .height = 45, .bit_depth = bits, .fps = 15.7609},
                Overwrite::force);
            for (int i = 0; i < 12; ++i) writer->write(frame_of(i, bits));
            EXPECT_TRUE(std::filesystem::exists(path + ".partial"));
            writer->finish();
            const auto frames = open_frames({path}, {});
            ASSERT_EQ(frames->count(), 12) << name << bits;
            EXPECT_EQ(frames->bit_depth(), bits) << name;
            ASSERT_TRUE(frames->frame_rate()) << name << bits;
            EXPECT_NEAR(*frames->frame_rate(), 15.7609, 0.05);
            for (int i = 0; i < 12; ++i) {
                EXPECT_EQ(frames->read(i).image, frame_of(i, bits).image) << name << bits << i;
            }
        }
    }
}

TEST(FrameWriter, PicturesGiveBackEveryCountAndKeepTheirNumbers) {
    for (const char* name : {"TIFF", "PNG"}) {
        const ImageFormat* format = find_image_format_named(name);
        for (const int bits : {8, 12, 16}) {
            const testing::ScratchFolder folder;
            const auto writer = make_frame_writer(
                folder / "frames",
                {.format = format, .width = 67, .height = 45, .bit_depth = bits, .fps = {}},
                Overwrite::refuse);
            for (const int i : {0, 1, 3}) writer->write(frame_of(i, bits));
            writer->finish();
            std::vector<std::filesystem::path> files;
            for (const auto& entry : std::filesystem::directory_iterator(folder / "frames")) {
                files.push_back(entry.path());
            }
            ASSERT_EQ(files.size(), 3U);
            const auto frames = open_frames(files, {});
            ASSERT_EQ(frames->count(), 4);
            EXPECT_EQ(frames->read(2).status, FrameStatus::missing);
            EXPECT_EQ(frames->read(3).image, frame_of(3, bits).image);
        }
    }
}

TEST(FrameWriter, AFolderKnowsWhichPicturesAreThereAndWhole) {
    for (const char* name : {"TIFF", "PNG"}) {
        for (const int bits : {8, 12}) {
            const testing::ScratchFolder folder;
            FrameWriterOptions options{.format = find_image_format_named(name),
                                       .width = 67,
                                       .height = 45,
                                       .bit_depth = bits,
                                       .fps = {}};
            const auto writer = make_frame_writer(folder / "f", options, Overwrite::refuse);
            for (const int i : {0, 1, 3}) writer->write(frame_of(i, bits));
            const std::string cut =
                folder / ("f/frame-000001." + std::string(options.format->extension));
            std::filesystem::resize_file(cut, std::filesystem::file_size(cut) / 2);
            EXPECT_TRUE(writer->holds(0)) << name << bits;
            EXPECT_FALSE(writer->holds(1)) << "cut";
            EXPECT_FALSE(writer->holds(2)) << "never written";
            EXPECT_TRUE(writer->holds(3));
            options.width = 66;
            EXPECT_FALSE(make_frame_writer(folder / "f", options, Overwrite::force)->holds(0))
                << "of another size";
        }
    }
    const testing::ScratchFolder folder;
    const auto video =
        make_frame_writer(folder / "x.avi", {.width = 67, .height = 45, .bit_depth = 8, .fps = 30},
                          Overwrite::refuse);
    video->write(frame_of(0, 8));
    EXPECT_FALSE(video->holds(0));
}

TEST(FrameWriter, CountsGiveBackTheImage) {
    for (const int bits : {8, 12, 16}) {
        const FrameWriterOptions options{.width = 67, .height = 45, .bit_depth = bits, .fps = {}};
        const Frame frame = frame_of(1, bits);
        std::vector<std::uint8_t> counts = counts_of(frame, options);
        EXPECT_EQ(image_of(counts, options), frame.image) << bits;
        counts.pop_back();
        EXPECT_THROW(image_of(counts, options), InputError);
    }
}

TEST(FrameWriter, SameFramesGiveTheSameBytes) {
    const testing::ScratchFolder folder;
    for (const char* name : {"a.avi", "b.avi"}) {
        const auto writer =
            make_frame_writer(folder / name, {.width = 67, .height = 45, .bit_depth = 8, .fps = 30},
                              Overwrite::refuse);
        for (int i = 0; i < 5; ++i) writer->write(frame_of(i, 8));
        writer->finish();
    }
    EXPECT_EQ(content(folder / "a.avi"), content(folder / "b.avi"));
}

TEST(FrameWriter, RefusesWhatWouldMislead) {
    const testing::ScratchFolder folder;
    const FrameWriterOptions options{.width = 67, .height = 45, .bit_depth = 8, .fps = {}};
    EXPECT_THROW(make_frame_writer(folder / "x.avi", options, Overwrite::refuse), OptionError);
    const auto writer = make_frame_writer(folder / "f", options, Overwrite::refuse);
    writer->write(frame_of(0, 8));
    EXPECT_THROW(writer->write(frame_of(1, 12)), OptionError);
    EXPECT_THROW(writer->write(frame_of(1, 8, 66)), OptionError);
    EXPECT_THROW(make_frame_writer(folder / "f", options, Overwrite::refuse), OutputError);
    EXPECT_NO_THROW(make_frame_writer(folder / "f", options, Overwrite::force));
}

TEST(FrameWriter, AVideoThatIsNotFinishedLeavesNothing) {
    const testing::ScratchFolder folder;
    const std::string path = folder / "x.avi";
    {
        const auto writer = make_frame_writer(
            path, {.width = 67, .height = 45, .bit_depth = 8, .fps = 30}, Overwrite::refuse);
        writer->write(frame_of(0, 8));
    }
    EXPECT_FALSE(std::filesystem::exists(path));
    EXPECT_FALSE(std::filesystem::exists(path + ".partial"));
}

}  // namespace
}  // namespace grainfield::io
