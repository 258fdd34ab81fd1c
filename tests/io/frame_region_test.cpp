#include "io/frame_region.h"

#include <vector>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/memory_frames.h"
#include "tests/support/collect.h"

namespace grainfield::io {
namespace {

std::unique_ptr<FrameSource> ramp(int width, int height) {
    Image image(width, height);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) image(x, y) = static_cast<float>(x + 100 * y);
    }
    Frame bad;
    bad.status = FrameStatus::corrupt;
    Frame good;
    good.image = image;
    return std::make_unique<MemoryFrames>(grainfield::testing::numbered({good, bad}));
}

TEST(FrameRegion, IsThatPartOfEveryFrame) {
    const auto region = region_within(std::vector{3, 5, 20, 17}, 40, 30);
    ASSERT_TRUE(region);
    const auto frames = crop_frames(ramp(40, 30), *region);
    EXPECT_EQ(frames->width(), 20);
    EXPECT_EQ(frames->height(), 17);
    const Frame frame = frames->read(0);
    ASSERT_EQ(frame.image.width(), 20);
    ASSERT_EQ(frame.image.height(), 17);
    EXPECT_EQ(frame.image(0, 0), 503);
    EXPECT_EQ(frame.image(19, 16), 22 + 2100);
    EXPECT_EQ(frames->read(1).status, FrameStatus::corrupt);
}

TEST(FrameRegion, OfNoNumbersIsNone) {
    EXPECT_FALSE(region_within({}, 40, 30));
}

TEST(FrameRegion, MustLieWithinTheFrame) {
    EXPECT_TRUE(region_within(std::vector{0, 0, 40, 30}, 40, 30));
    for (const std::vector<int>& sides :
         std::vector<std::vector<int>>{{1, 0, 40, 30},
                                       {0, -1, 20, 20},
                                       {0, 0, 0, 0},
                                       {0, 0, 20},
                                       {0, 0, 20, 20, 1},
                                       {2000000000, 0, 2000000000, 20}}) {
        EXPECT_THROW(region_within(sides, 40, 30), OptionError) << sides.size();
    }
}

TEST(FlatField, IsDividedOutAndTheMeanLevelStays) {
    Image flat(40, 30);
    for (int y = 0; y < 30; ++y) {
        for (int x = 0; x < 40; ++x) flat(x, y) = static_cast<float>(100 + 2 * x);
    }
    double mean = 0;
    for (const float v : flat.pixels()) mean += static_cast<double>(v) / 1200;
    Frame lit;
    lit.image = flat;
    const auto frames =
        flatten_frames(std::make_unique<MemoryFrames>(std::vector<Frame>{lit}), flat);
    const Frame frame = frames->read(0);
    for (const float v : frame.image.pixels()) {
        EXPECT_NEAR(static_cast<double>(v), mean, 1e-3);
    }
}

TEST(FlatField, MustHaveTheSizeOfTheFramesAndLightEverywhere) {
    EXPECT_THROW(flatten_frames(ramp(40, 30), Image(41, 30, 1)), InputError);
    EXPECT_THROW(flatten_frames(ramp(40, 30), Image(40, 30, 0)), InputError);
}

}  // namespace
}  // namespace grainfield::io
