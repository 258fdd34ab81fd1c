#include "io/images/phantom_cine.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "io/frame_files.h"
#include "tests/io/cine_writer.h"
#include "tests/io/film_file.h"
#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::ThrowsMessage;

constexpr int width = CineWriter::width, height = CineWriter::height;

class PhantomCine : public FilmFile {
 protected:
    PhantomCine() : FilmFile("film.cine") {}

    void expect_counts(const CineWriter& writer, int depth) {
        const auto film = open(writer.text(4), {.fps = {}, .knows_filter = true});
        ASSERT_EQ(film->count(), 4);
        EXPECT_EQ(film->bit_depth(), depth);
        EXPECT_EQ(film->frame_rate(), 500.0);
        for (const std::int64_t i : {3, 0, 2, 1}) {
            const Frame frame = film->read(i);
            EXPECT_TRUE(holds_counts(frame.image, width, height, depth, static_cast<int>(i)))
                << writer.bits << ", " << writer.packing << ", " << depth
                << " bit: " << frame.message;
            EXPECT_NEAR(frame.time, 0.002 * static_cast<double>(i), 1e-6);
        }
    }
};

TEST_F(PhantomCine, KeepsEveryBitAndTheStamps) {
    for (const auto& [bits, real] :
         {std::pair{8, 8}, {16, 10}, {16, 12}, {16, 14}, {16, 16}, {24, 8}, {48, 12}}) {
        expect_counts({.bits = bits, .real_bits = real}, real);
    }
    expect_counts({.is_upright = true}, 12);
    expect_counts({.note = 30}, 12);
}

TEST_F(PhantomCine, KeepsEveryBitOfPackedPixels) {
    expect_counts({.real_bits = 10, .packing = 0x100}, 10);
    expect_counts({.real_bits = 12, .packing = 0x400}, 12);
    const auto curved = open(CineWriter{.real_bits = 10, .packing = 0x100}.text(4));
    EXPECT_THAT(curved->warnings(), ElementsAre(HasSubstr("on a curve of the camera")));
    EXPECT_THAT(open(CineWriter{.packing = 0x400}.text(4))->warnings(), IsEmpty());
}

TEST_F(PhantomCine, NamesTheColourFilterOfRawFrames) {
    const CineWriter bayer{.kind = 2, .real_bits = 14, .filter = 3};
    expect_counts(bayer, 14);
    EXPECT_THAT(open(bayer.text(4))->warnings(), ElementsAre(HasSubstr("'mosaic' gbrg")));
    EXPECT_THAT(open(CineWriter{.kind = 2, .filter = 4}.text(4))->warnings(),
                ElementsAre(HasSubstr("'mosaic' rggb")));
    const CineWriter packed{.kind = 2, .real_bits = 10, .packing = 0x100, .filter = 4};
    expect_counts(packed, 10);
}

TEST_F(PhantomCine, BelievesStampsAgainstTheHeader) {
    const auto film = open(CineWriter{.rate = 30}.text(4));
    EXPECT_NEAR(*film->frame_rate(), 500, 0.1);
    EXPECT_THAT(film->warnings(), ElementsAre(HasSubstr("declares 30")));
    const auto bare = open(CineWriter{.step_us = 0}.text(4));
    EXPECT_EQ(bare->frame_rate(), 500.0);
    EXPECT_DOUBLE_EQ(bare->read(3).time, 0.006);
}

TEST_F(PhantomCine, CutKeepsTheWholeFramesAndNeverCrashes) {
    const CineWriter writer{.real_bits = 10, .packing = 0x100};
    const std::string whole = writer.text(4);
    for (std::size_t cut = 1; cut < whole.size(); cut += cut < 7000 ? 97 : 13) {
        write_content(path_, whole.substr(0, cut));
        int left = 0;
        while (left < 4 && writer.place(left + 1, 4) <= cut) ++left;
        if (left == 0) {
            EXPECT_THAT([&] { open_frames({path_}, {}); },
                        ThrowsMessage<InputError>(HasSubstr("film.cine")))
                << cut;
            continue;
        }
        const auto film = open_frames({path_}, {});
        ASSERT_EQ(film->count(), left) << cut;
        EXPECT_THAT(film->warnings().front(),
                    HasSubstr(fmt::format("{} whole frames of 4 declared", left)));
        EXPECT_TRUE(holds_counts(film->read(left - 1).image, width, height, 10, left - 1));
    }
}

TEST_F(PhantomCine, WithADamagedImageKeepsTheOthersAndSaysWhere) {
    const CineWriter writer;
    const std::string whole = writer.text(4);
    const auto second_of = [&](const std::string& damaged) {
        const auto film = open(damaged);
        EXPECT_EQ(film->count(), 4);
        EXPECT_TRUE(holds_counts(film->read(0).image, width, height, 12, 0));
        EXPECT_TRUE(holds_counts(film->read(2).image, width, height, 12, 2));
        const Frame frame = film->read(1);
        EXPECT_EQ(frame.status, FrameStatus::corrupt);
        return frame.message;
    };
    const std::size_t place = writer.place(1, 4);
    std::string loud = whole;
    loud[place + 8 + 101] = '\x7f';
    EXPECT_THAT(second_of(loud), HasSubstr(fmt::format("byte {}: a count of", place + 8)));
    std::string length = whole;
    length[place + 4] ^= 4;
    EXPECT_THAT(second_of(length), HasSubstr(fmt::format("byte {}: an image of", place + 4)));
    std::string offset = whole;
    offset[writer.table_at(4) + 8 + 6] = 1;
    EXPECT_THAT(second_of(offset), HasSubstr("beyond the end"));
    std::string note = whole;
    note[place] = 3;
    EXPECT_THAT(second_of(note), HasSubstr("a note of 3 bytes"));
}

TEST_F(PhantomCine, WithHugeSizesIsRefusedBeforeMemoryIsAskedFor) {
    std::string huge = CineWriter{}.text(4);
    huge[CineWriter::bitmap_at + 6] = 127;
    huge[CineWriter::bitmap_at + 10] = 127;
    EXPECT_THAT([&] { open(huge); }, ThrowsMessage<InputError>(HasSubstr("film.cine")));
    EXPECT_THAT([&] { open(huge, {.fps = {}, .max_pixels = 1LL << 62}); },
                ThrowsMessage<InputError>(HasSubstr("no whole frame")));
    EXPECT_EQ(open(CineWriter{.declared = 0xffffffff}.text(4))->count(), 4);
}

TEST_F(PhantomCine, WithRandomBytesChangedNeverCrashes) {
    const std::string whole = CineWriter{.kind = 2, .filter = 3}.text(4);
    RandomStream random(1, "cine bytes");
    const std::size_t table = CineWriter{}.table_at(4);
    for (int i = 0; i < 600; ++i) {
        std::string damaged = whole;
        for (int n = 0; n < 3; ++n) {
            // What decides stands in the headers and around the table.
            const std::array places{random.below(84), CineWriter::setup_at + random.below(900),
                                    CineWriter::times_at + random.below(whole.size() - table)};
            damaged[places[static_cast<std::size_t>(n)]] = static_cast<char>(random.below(256));
        }
        opens_or_is_refused(damaged);
    }
}

TEST_F(PhantomCine, OfOtherKindsIsRefusedWithAWayRound) {
    // Its offsets have 32 bit: read as 64, two of them make one place.
    EXPECT_THAT([&] { open(CineWriter{.version = 0}.text(4)); },
                ThrowsMessage<InputError>(
                    AllOf(HasSubstr("film.cine"), HasSubstr("version 0"), HasSubstr("version 1"))));
    EXPECT_THAT([&] { open(CineWriter{.kind = 1}.text(4)); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("JPEG"), HasSubstr("TIFF"))));
    EXPECT_THAT([&] { open(CineWriter{.packing = 0x200}.text(4)); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("0x200"), HasSubstr("TIFF"))));
    EXPECT_THAT([&] { open(CineWriter{.bits = 8}.text(4)); },
                ThrowsMessage<InputError>(HasSubstr("12 of them used")));
}

TEST_F(PhantomCine, InPartsIsOneFilmByItsStamps) {
    write_content(folder_ / "a1.cine", CineWriter{}.text(4));
    write_content(folder_ / "a2.cine", CineWriter{}.text(4));
    // Both begin at the same second: they are not one after the other.
    const auto film = open_frames({folder_ / "a1.cine", folder_ / "a2.cine"}, {});
    EXPECT_EQ(film->count(), 8);
    EXPECT_TRUE(holds_counts(film->read(6).image, width, height, 12, 2));
    EXPECT_FALSE(film->warnings().empty());
}

}  // namespace
}  // namespace grainfield::io
