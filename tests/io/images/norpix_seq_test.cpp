#include "io/images/norpix_seq.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "io/frame_files.h"
#include "tests/io/film_file.h"
#include "tests/io/picture_files.h"
#include "tests/io/seq_writer.h"

namespace grainfield::io {
namespace {

using namespace picture_files;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int width = SeqWriter::width, height = SeqWriter::height;

class NorpixSeq : public FilmFile {
 protected:
    NorpixSeq() : FilmFile("film.seq") {}
};

TEST_F(NorpixSeq, KeepsEveryBitAndTheStamps) {
    for (const int version : {3, 5}) {
        for (const auto& [stored, real] : {std::pair{8U, 8U}, {16U, 10U}, {16U, 12U}, {16U, 16U}}) {
            const SeqWriter writer{.version = version, .stored_bits = stored, .real_bits = real};
            const auto film = open(writer.text(4));
            ASSERT_EQ(film->count(), 4);
            EXPECT_EQ(film->bit_depth(), static_cast<int>(real));
            EXPECT_EQ(film->frame_rate(), 500.0);
            EXPECT_TRUE(film->warnings().empty());
            for (const std::int64_t i : {3, 0, 2, 1}) {
                const Frame frame = film->read(i);
                EXPECT_TRUE(holds_counts(frame.image, width, height, static_cast<int>(real),
                                         static_cast<int>(i)))
                    << version << ", " << real << " bit";
                EXPECT_NEAR(frame.time, 0.002 * static_cast<double>(i), 1e-6);
            }
        }
    }
    EXPECT_DOUBLE_EQ(open(SeqWriter{}.text(4), {.fps = 100})->read(2).time, 0.02);
}

TEST_F(NorpixSeq, HasStampsOfMicrosecondsFromVersion5On) {
    EXPECT_NEAR(open(SeqWriter{.version = 5, .step_us = 2345}.text(4))->read(1).time, 0.002345,
                1e-6);
    // Nothing but the stamp behind an image: eight bytes would run into the next.
    const auto old = open(SeqWriter{.version = 4, .step_us = 2345, .padding = 0}.text(4));
    ASSERT_EQ(old->count(), 4);
    EXPECT_NEAR(old->read(3).time, 0.007, 1e-6);
    EXPECT_TRUE(holds_counts(old->read(3).image, width, height, 12, 3));
}

TEST_F(NorpixSeq, BelievesStampsAgainstTheHeader) {
    const auto film = open(SeqWriter{.rate = 30}.text(4));
    EXPECT_NEAR(*film->frame_rate(), 500, 0.1);
    ASSERT_EQ(film->warnings().size(), 1U);
    EXPECT_THAT(film->warnings()[0], HasSubstr("declares 30"));
    const auto still = open(SeqWriter{.step_us = 0}.text(4));
    EXPECT_EQ(still->frame_rate(), 500.0);
    EXPECT_THAT(still->warnings().at(0), HasSubstr("do not increase at frame 1"));
}

TEST_F(NorpixSeq, OfTwoPartsIsOneFilmWithItsGap) {
    write_content(folder_ / "a1.seq", SeqWriter{}.text(4));
    write_content(folder_ / "a2.seq", SeqWriter{.first_second = 1001}.text(4));
    const auto film = open_frames({folder_ / "a1.seq", folder_ / "a2.seq"}, {});
    // 1 s from the first frame to the fifth, 500 a second.
    ASSERT_EQ(film->count(), 504);
    EXPECT_EQ(film->read(4).status, FrameStatus::missing);
    EXPECT_TRUE(holds_counts(film->read(500).image, width, height, 12, 0));
    EXPECT_NEAR(film->read(500).time, 1, 1e-6);
}

TEST_F(NorpixSeq, CutKeepsTheWholeFramesAndNeverCrashes) {
    const std::string whole = SeqWriter{}.text(4);
    const std::size_t frame = width * height * 2 + 6 + 100;
    for (std::size_t cut = 1; cut < whole.size(); cut += 97) {
        write_content(path_, whole.substr(0, cut));
        const std::size_t left = cut < 1024 ? 0 : (cut - 1024 + 100) / frame;
        if (left == 0) {
            EXPECT_THROW(open_frames({path_}, {}), InputError) << cut;
            continue;
        }
        const auto film = open_frames({path_}, {});
        ASSERT_EQ(film->count(), static_cast<std::int64_t>(left)) << cut;
        EXPECT_EQ(film->warnings().size(), left < 4 ? 1U : 0U) << cut;
        EXPECT_TRUE(holds_counts(film->read(film->count() - 1).image, width, height, 12,
                                 static_cast<int>(left) - 1));
    }
}

TEST_F(NorpixSeq, WithRandomBytesChangedNeverCrashes) {
    const std::string whole = SeqWriter{}.text(4);
    RandomStream random(1, "norpix bytes");
    for (int i = 0; i < 400; ++i) {
        std::string damaged = whole;
        for (int n = 0; n < 4; ++n) {
            // Most of the header decides nothing: half the blows fall where it does.
            const std::size_t at = n % 2 == 0 ? 546 + random.below(78) : random.below(whole.size());
            damaged[at] = static_cast<char>(random.below(256));
        }
        opens_or_is_refused(damaged);
    }
}

TEST_F(NorpixSeq, OfOtherKindsIsRefusedWithAWayRound) {
    EXPECT_THAT([&] { open(SeqWriter{.format = 102}.text(4)); },
                ThrowsMessage<InputError>(HasSubstr("image format 102")));
    EXPECT_THAT([&] { open(SeqWriter{.real_bits = 17}.text(4)); },
                ThrowsMessage<InputError>(HasSubstr("17 of them used")));
    const std::string bayer = SeqWriter{.format = 101}.text(4);
    EXPECT_THAT(open(bayer)->warnings().at(0), HasSubstr("mosaic"));
    EXPECT_TRUE(open(bayer, {.fps = {}, .knows_filter = true})->warnings().empty());
    EXPECT_THAT([&] { open(SeqWriter{.compression = 1}.text(4)); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("compression 1"), HasSubstr("TIFF"))));
    std::string loud = SeqWriter{}.text(4);
    loud[1024 + 1] = '\x7f';  // 0x7f.. is above 12 bit
    const Frame frame = open(loud)->read(0);
    EXPECT_EQ(frame.status, FrameStatus::corrupt);
    EXPECT_THAT(frame.message, HasSubstr("byte 1024"));
}

}  // namespace
}  // namespace grainfield::io
