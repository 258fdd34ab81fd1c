#include "core/memory_frames.h"

#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield {
namespace {

TEST(MemoryFrames, GivesImagesWithTheirIndexAndTime) {
    MemoryFrames frames({Image(4, 3, 1.0F), Image(4, 3, 2.0F)}, 50.0, "two");
    EXPECT_EQ(frames.count(), 2);
    EXPECT_EQ(frames.width(), 4);
    EXPECT_EQ(frames.height(), 3);
    const Frame last = frames.read(1);
    EXPECT_EQ(last.status, FrameStatus::ok);
    EXPECT_EQ(last.index, 1);
    EXPECT_DOUBLE_EQ(last.time, 0.02);
    EXPECT_EQ(last.image, Image(4, 3, 2.0F));
    EXPECT_DOUBLE_EQ(MemoryFrames({Image(1, 1), Image(1, 1)}).read(1).time, 1);
}

TEST(MemoryFrames, KeepsTheIndicesOfFramesAndBadOnesAmongThem) {
    Frame bad;
    bad.status = FrameStatus::corrupt;
    bad.index = 7;
    Frame good;
    good.image = Image(4, 3, 2.0F);
    good.index = 14;
    MemoryFrames frames(std::vector<Frame>{bad, good});
    EXPECT_EQ(frames.width(), 4);
    EXPECT_EQ(frames.read(0).status, FrameStatus::corrupt);
    EXPECT_EQ(frames.read(0).index, 7);
    EXPECT_EQ(frames.read(1).index, 14);
}

TEST(MemoryFrames, RefuseWhatIsNoFilm) {
    EXPECT_THROW(MemoryFrames(std::vector<Image>{}), InputError);
    EXPECT_THROW(MemoryFrames(std::vector<Frame>(2)), InputError) << "bad frames alone";
    EXPECT_THROW(MemoryFrames({Image()}), InputError);
    EXPECT_THROW(MemoryFrames({Image(4, 3), Image(3, 4)}), InputError);
    MemoryFrames frames({Image(4, 3)});
    EXPECT_THROW(frames.read(1), OptionError);
    EXPECT_THROW(frames.read(-1), OptionError);
}

}  // namespace
}  // namespace grainfield
