#include "io/images/picture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/memory_frames.h"

namespace grainfield::io {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(OnlyPicture, IsTheFrameOfAFilmThatHasOne) {
    MemoryFrames film(std::vector<Image>{Image(3, 2, 40)});
    const Picture picture = only_picture(film, "flat.seq");
    EXPECT_EQ(picture.image, Image(3, 2, 40));
    EXPECT_EQ(picture.bit_depth, film.read(0).bit_depth);
}

TEST(OnlyPicture, OfSeveralFramesIsRefusedWithTheirNumber) {
    MemoryFrames film(std::vector<Image>(4, Image(3, 2, 40)));
    EXPECT_THAT([&] { only_picture(film, "flat.seq"); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("'flat.seq' is not one picture"),
                                                HasSubstr("it holds 4 frames"),
                                                HasSubstr("give it as a film"))));
}

TEST(OnlyPicture, OfADamagedFrameIsRefusedWithItsMessage) {
    // A source needs one good frame to know its size.
    std::vector<Frame> frames(2);
    frames[0].status = FrameStatus::corrupt;
    frames[0].message = "byte 1024 is odd";
    frames[1].image = Image(3, 2, 40);
    MemoryFrames film(frames);
    EXPECT_THAT([&] { only_picture(film, "flat.seq"); },
                ThrowsMessage<InputError>(HasSubstr("byte 1024 is odd")));
}

}  // namespace
}  // namespace grainfield::io
