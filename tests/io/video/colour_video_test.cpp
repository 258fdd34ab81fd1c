#include "io/video/colour_video.h"

#include <cmath>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/frame_files.h"
#include "tests/support/scratch_folder.h"

namespace grainfield::io {
namespace {

using testing::ScratchFolder;

std::vector<std::uint8_t> uniform(int width, int height, std::uint8_t r, std::uint8_t g,
                                  std::uint8_t b) {
    std::vector<std::uint8_t> rgb;
    for (int i = 0; i < width * height; ++i) rgb.insert(rgb.end(), {r, g, b});
    return rgb;
}

TEST(ColourVideo, HasTheFramesTheRateAndTheLumaThatWereGiven) {
    const ScratchFolder folder;
    for (const char* name : {"a.mp4", "a.mkv", "a.mov"}) {
        const std::filesystem::path path = folder / name;
        ColourVideo video(path, {.width = 64, .height = 48, .fps = 30}, Overwrite::refuse);
        for (int i = 0; i < 7; ++i) {
            video.write(uniform(64, 48, static_cast<std::uint8_t>(30 * i), 0, 200));
        }
        EXPECT_FALSE(std::filesystem::exists(path)) << "not before it is complete";
        video.finish();
        const auto frames = open_frames({path}, {});
        EXPECT_EQ(frames->count(), 7) << name;
        EXPECT_EQ(frames->width(), 64);
        EXPECT_EQ(frames->height(), 48);
        EXPECT_NEAR(frames->frame_rate().value(), 30, 1e-6);
        for (int i = 0; i < 7; ++i) {
            const double luma = 16 + 0.256788 * 30 * i + 0.097906 * 200;
            EXPECT_NEAR(frames->read(i).image(32, 24), luma, 3) << name << " " << i;
        }
    }
}

TEST(ColourVideo, OfAnOddSizeLosesItsLastColumnAndRow) {
    const ScratchFolder folder;
    ColourVideo video(folder / "odd.mp4", {.width = 33, .height = 17}, Overwrite::refuse);
    video.write(uniform(33, 17, 255, 255, 255));
    video.finish();
    const auto frames = open_frames({folder / "odd.mp4"}, {});
    EXPECT_EQ(frames->width(), 32);
    EXPECT_EQ(frames->height(), 16);
}

TEST(ColourVideo, RefusesOtherNamesSizesAndPictures) {
    const ScratchFolder folder;
    EXPECT_THROW(ColourVideo(folder / "a.gif", {.width = 64, .height = 48}, Overwrite::refuse),
                 OptionError);
    EXPECT_THROW(ColourVideo(folder / "a.mp4", {.width = 0, .height = 48}, Overwrite::refuse),
                 OptionError);
    EXPECT_THROW(
        ColourVideo(folder / "a.mp4", {.width = 64, .height = 48, .fps = 0}, Overwrite::refuse),
        OptionError);
    EXPECT_THROW(
        ColourVideo(folder / "absent/a.mp4", {.width = 64, .height = 48}, Overwrite::refuse),
        OutputError);
    ColourVideo video(folder / "a.mp4", {.width = 64, .height = 48}, Overwrite::refuse);
    EXPECT_THROW(video.write(uniform(64, 47, 0, 0, 0)), OptionError);
}

TEST(ColourVideo, ThatIsNotFinishedLeavesNothing) {
    const ScratchFolder folder;
    {
        ColourVideo video(folder / "a.mp4", {.width = 64, .height = 48}, Overwrite::refuse);
        video.write(uniform(64, 48, 1, 2, 3));
    }
    EXPECT_EQ(folder.entries(), 0U);
}

}  // namespace
}  // namespace grainfield::io
