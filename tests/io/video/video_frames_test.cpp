#include "io/video/video_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;
using ::testing::HasSubstr;

constexpr int width = 64, height = 48, frame_count = 40;

/// Writes the known counts as a video; skips the test if there is no such encoder.
bool encode(const testing::ScratchFolder& folder, int depth, const std::string& arguments) {
    std::string raw;
    for (int frame = 0; frame < frame_count; ++frame) {
        for (int y = 0; y < height; ++y) {
            const auto row = row_bytes(width, y, depth, frame, 1);
            raw.append(row.begin(), row.end());
        }
    }
    write_content(folder / "raw", raw);
    return ffmpeg("-f rawvideo -s 64x48 -r 50 -pix_fmt " +
                  std::string(depth == 16 ? "gray16le" : "gray") + " -i " + folder / "raw" + " " +
                  arguments);
}

#define ENCODE_OR_SKIP(...) \
    if (!encode(__VA_ARGS__)) GTEST_SKIP() << "no ffmpeg program with this encoder"

/// Reads in a scattered order and compares with reading one after the other.
void expect_any_order_equal(const std::filesystem::path& path) {
    const auto straight = open_video(path, {});
    std::vector<Frame> frames;
    for (std::int64_t i = 0; i < straight->count(); ++i) frames.push_back(straight->read(i));
    const auto scattered = open_video(path, {});
    const std::int64_t n = scattered->count();
    for (std::int64_t i = 0; i < 2 * n; ++i) {
        const std::int64_t at = (i * 17 + 5) % n;
        const Frame frame = scattered->read(at);
        const Frame& expected = frames[static_cast<std::size_t>(at)];
        EXPECT_EQ(frame.status, expected.status) << at << ": " << frame.message;
        EXPECT_EQ(frame.image, expected.image) << at;
        EXPECT_EQ(frame.time, expected.time);
    }
}

TEST(VideoFrames, OfLosslessVideoAreBitExactInAnyOrder) {
    const testing::ScratchFolder folder;
    for (const int depth : {8, 16}) {
        for (const char* name : {"x.mkv", "x.avi", "x.nut"}) {
            const std::string path = folder / name;
            ENCODE_OR_SKIP(folder, depth, "-c:v ffv1 -level 3 -slices 4 -slicecrc 1 " + path);
            const auto frames = open_video(path, {});
            ASSERT_EQ(frames->count(), frame_count) << name;
            EXPECT_EQ(frames->bit_depth(), depth);
            EXPECT_TRUE(frames->warnings().empty()) << frames->warnings().front();
            ASSERT_TRUE(frames->frame_rate());
            EXPECT_NEAR(*frames->frame_rate(), 50, 1e-9);
            for (int i = 0; i < frame_count; ++i) {
                const Frame frame = frames->read(i);
                EXPECT_TRUE(holds_counts(frame.image, width, height, depth, i)) << name << i;
                EXPECT_NEAR(frame.time, i / 50.0, 5e-4);  // Matroska counts milliseconds
            }
            expect_any_order_equal(path);
        }
    }
}

TEST(VideoFrames, ThatAreReorderedInTheFileComeInOrderOfTime) {
    const testing::ScratchFolder folder;
    for (const char* name : {"x.mp4", "x.mkv", "x.ts", "x.avi"}) {
        // Lossless H.264 with B-frames; open groups of pictures make jumps difficult.
        ENCODE_OR_SKIP(
            folder, 8,
            "-c:v libx264 -qp 0 -bf 3 -g 8 -x264-params open-gop=1 -pix_fmt gray " + folder / name);
        const auto frames = open_video(folder / name, {});
        ASSERT_EQ(frames->count(), frame_count) << name;
        for (int i = 0; i < frame_count; ++i) {
            const Frame frame = frames->read(i);
            EXPECT_TRUE(holds_counts(frame.image, width, height, 8, i))
                << name << i << frame.message;
        }
        expect_any_order_equal(folder / name);
    }
}

TEST(VideoFrames, OfAStreamWithoutClockHaveTheRateOfItsCodeOrNone) {
    const testing::ScratchFolder folder;
    ENCODE_OR_SKIP(folder, 8, "-c:v libx264 -qp 0 -bf 2 -g 10 -pix_fmt gray " + folder / "x.h264");
    const auto coded = open_video(folder / "x.h264", {});
    EXPECT_EQ(coded->count(), frame_count);
    EXPECT_EQ(coded->frame_rate(), 50);
    EXPECT_TRUE(holds_counts(coded->read(30).image, width, height, 8, 30));
    EXPECT_DOUBLE_EQ(coded->read(30).time, 0.6);
    expect_any_order_equal(folder / "x.h264");

    ENCODE_OR_SKIP(folder, 8, "-c:v mjpeg -pix_fmt yuvj420p " + folder / "x.mjpeg");
    const auto none = open_video(folder / "x.mjpeg", {});
    EXPECT_EQ(none->count(), frame_count);
    EXPECT_FALSE(none->frame_rate());
    EXPECT_EQ(none->read(30).time, 30);
    const auto given = open_video(folder / "x.mjpeg", {.fps = 120});
    EXPECT_EQ(given->frame_rate(), 120);
    EXPECT_DOUBLE_EQ(given->read(30).time, 0.25);
}

TEST(VideoFrames, OfColourAreTheirLuma) {
    const testing::ScratchFolder folder;
    ENCODE_OR_SKIP(folder, 8, "-c:v ffv1 -pix_fmt bgr0 " + folder / "x.mkv");
    EXPECT_TRUE(holds_counts(open_video(folder / "x.mkv", {})->read(3).image, width, height, 8, 3));
}

TEST(VideoFrames, OfACutFileKeepTheWholeOnesWithAWarning) {
    const testing::ScratchFolder folder;
    for (const char* name : {"x.mkv", "x.avi"}) {
        ENCODE_OR_SKIP(folder, 16, "-c:v ffv1 -level 3 -slicecrc 1 -g 1 " + folder / name);
        const std::string whole = content_of(folder / name);
        for (int percent = 20; percent < 95; percent += 7) {
            const std::string path = folder / (std::string("cut-") + name);
            write_content(path,
                          whole.substr(0, whole.size() * static_cast<unsigned>(percent) / 100));
            const auto frames = open_video(path, {});
            const int n = static_cast<int>(frames->count());
            EXPECT_NEAR(n, frame_count * percent / 100, 3) << name;
            EXPECT_FALSE(frames->warnings().empty()) << name << percent;
            for (int i = 0; i < n; ++i) {
                EXPECT_TRUE(holds_counts(frames->read(i).image, width, height, 16, i)) << name << i;
            }
        }
    }
}

TEST(VideoFrames, CutAnywhereNeverCrash) {
    const testing::ScratchFolder folder;
    for (const char* name : {"x.mkv", "x.mp4", "x.nut"}) {
        ENCODE_OR_SKIP(folder, 8, "-c:v libx264 -bf 2 -pix_fmt yuv420p " + folder / name);
        const std::string whole = content_of(folder / name);
        for (std::size_t n = 1; n < whole.size(); n += 1 + whole.size() / 40) {
            write_content(folder / "cut", whole.substr(0, n));
            try {
                const auto frames = open_video(folder / "cut", {});
                for (std::int64_t i = 0; i < frames->count(); ++i) frames->read(i);
            } catch (const InputError& error) {
                EXPECT_THAT(error.what(), HasSubstr("cut"));
            }
        }
    }
}

TEST(VideoFrames, WithAWrongChecksumAreCorruptAndTheirNeighboursAreNot) {
    const testing::ScratchFolder folder;
    ENCODE_OR_SKIP(folder, 16, "-c:v ffv1 -level 3 -slices 4 -slicecrc 1 -g 1 " + folder / "x.avi");
    std::string content = content_of(folder / "x.avi");
    content[content.size() / 2] = static_cast<char>(content[content.size() / 2] ^ 1);
    write_content(folder / "x.avi", content);
    const auto frames = open_video(folder / "x.avi", {});
    ASSERT_EQ(frames->count(), frame_count);
    int corrupt = 0;
    for (int i = 0; i < frame_count; ++i) {
        const Frame frame = frames->read(i);
        EXPECT_EQ(frame.index, i);
        if (frame.status == FrameStatus::ok) {
            EXPECT_TRUE(holds_counts(frame.image, width, height, 16, i)) << i;
        } else {
            ++corrupt;
            EXPECT_THAT(frame.message, HasSubstr("CRC"));
            EXPECT_TRUE(frame.image.empty());
        }
    }
    EXPECT_EQ(corrupt, 1);
    expect_any_order_equal(folder / "x.avi");
}

TEST(VideoFrames, ThatBuildOnADamagedOneAreCorruptUpToTheNextKeyFrame) {
    const testing::ScratchFolder folder;
    ENCODE_OR_SKIP(folder, 16,
                   "-c:v ffv1 -level 3 -slices 4 -slicecrc 1 -g 10 " + folder / "x.avi");
    std::string content = content_of(folder / "x.avi");
    content[content.size() / 2] = static_cast<char>(content[content.size() / 2] ^ 1);
    write_content(folder / "x.avi", content);
    const auto frames = open_video(folder / "x.avi", {});
    int first = -1;
    for (int i = 0; i < frame_count; ++i) {
        const Frame frame = frames->read(i);
        if (first < 0 && frame.status == FrameStatus::corrupt) first = i;
        const bool builds_on_it = first >= 0 && i / 10 == first / 10;
        EXPECT_EQ(frame.status, builds_on_it ? FrameStatus::corrupt : FrameStatus::ok) << i;
    }
    EXPECT_GE(first, 0);
    expect_any_order_equal(folder / "x.avi");
}

TEST(VideoFrames, WithTimesThatDoNotIncreaseAreWarnedOf) {
    const testing::ScratchFolder folder;
    ENCODE_OR_SKIP(
        folder, 8,
        "-c:v ffv1 -g 1 -bsf:v setts=ts='if(eq(N\\,5)\\,TS+200\\,TS)' " + folder / "x.mkv");
    const auto frames = open_video(folder / "x.mkv", {});
    ASSERT_EQ(frames->count(), frame_count);
    ASSERT_EQ(frames->warnings().size(), 1U);
    EXPECT_THAT(frames->warnings()[0], HasSubstr("frame 6"));
    EXPECT_EQ(frames->read(5).time, frames->read(6).time);
    EXPECT_TRUE(holds_counts(frames->read(6).image, width, height, 8, 6));
}

TEST(VideoFrames, AboveThePixelCapAreRefused) {
    const testing::ScratchFolder folder;
    ENCODE_OR_SKIP(folder, 8, "-c:v ffv1 " + folder / "x.mkv");
    EXPECT_THROW(open_video(folder / "x.mkv", {.fps = {}, .max_pixels = width * height - 1}),
                 InputError);
}

TEST(VideoFrames, OfAPlaylistAreRefusedWithoutOpeningWhatItNames) {
    const testing::ScratchFolder folder;
    ENCODE_OR_SKIP(folder, 8, "-c:v ffv1 " + folder / "x.mkv");
    write_content(folder / "list.txt", "ffconcat version 1.0\nfile x.mkv\n");
    write_content(folder / "list.m3u8", "#EXTM3U\n#EXTINF:1,\nx.mkv\n#EXT-X-ENDLIST\n");
    EXPECT_THROW(open_video(folder / "list.txt", {}), InputError);
    EXPECT_THROW(open_video(folder / "list.m3u8", {}), InputError);
}

}  // namespace
}  // namespace grainfield::io
