#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "io/frame_files.h"
#include "tests/io/dng_writer.h"
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

constexpr int width = DngWriter::width, height = DngWriter::height;

class Dng : public FilmFile {
 protected:
    Dng() : FilmFile("shot.dng") {}
};

TEST_F(Dng, KeepsEveryBitOfTheSensor) {
    for (const int bits : {10, 12, 14, 16}) {
        for (const bool is_big_endian : {false, true}) {
            for (const bool is_below : {false, true}) {
                const DngWriter writer{
                    .bits = bits, .is_big_endian = is_big_endian, .is_below = is_below};
                const auto film = open(writer.text());
                ASSERT_EQ(film->count(), 1);
                EXPECT_EQ(film->bit_depth(), bits);
                EXPECT_TRUE(holds_counts(film->read(0).image, width, height, bits))
                    << bits << ", " << is_big_endian << ", " << is_below;
            }
        }
    }
}

// DNG specification, tag 50712: a stored value is an index; beyond the end the last entry holds.
TEST_F(Dng, GoesThroughItsTableToCountsInProportionToLight) {
    for (const auto& [bits, entries] :
         {std::pair{8, 200U}, {10, 600U}, {14, 9000U}, {16, 40000U}}) {
        std::vector<std::uint16_t> table(entries);
        for (std::size_t i = 0; i < entries; ++i) {
            table[i] = static_cast<std::uint16_t>(7 + 4000 * i * i / (entries * entries));
        }
        for (const bool is_big_endian : {false, true}) {
            const DngWriter writer{.bits = bits,
                                   .is_big_endian = is_big_endian,
                                   .is_below = bits != 8,
                                   .table = table};
            const auto film = open(writer.text(), {.fps = {}, .knows_filter = true});
            EXPECT_EQ(film->bit_depth(), 12) << "4,006 is the largest count";
            const Frame frame = film->read(0);
            ASSERT_EQ(frame.image.size(), static_cast<std::size_t>(width * height))
                << frame.message;
            bool is_beyond = false;
            for (int y = 0; y < height; ++y) {
                for (int x = 0; x < width; ++x) {
                    const std::size_t stored = count_at(x, y, bits, 0);
                    is_beyond = is_beyond || stored >= entries;
                    ASSERT_EQ(frame.image(x, y), table[std::min<std::size_t>(stored, entries - 1)])
                        << bits << " bit, " << x << ", " << y;
                }
            }
            EXPECT_TRUE(is_beyond) << bits << " bit";
        }
    }
}

TEST_F(Dng, WithATableThatCannotBeReadIsRefused) {
    const DngWriter writer{.bits = 16, .table = std::vector<std::uint16_t>(65536, 1)};
    EXPECT_THAT([&] { open(writer.text()); },
                ThrowsMessage<InputError>(
                    AllOf(HasSubstr("LinearizationTable"), HasSubstr("at most 65,535"))));
}

TEST_F(Dng, NamesItsColourFilter) {
    EXPECT_THAT(open(DngWriter{}.text())->warnings(), ElementsAre(HasSubstr("'mosaic' rggb")));
    EXPECT_THAT(open(DngWriter{.pattern = {2, 1, 1, 0}}.text())->warnings(),
                ElementsAre(HasSubstr("'mosaic' bggr")));
    EXPECT_THAT(open(DngWriter{.pattern = {1, 2, 0, 1}}.text())->warnings(),
                ElementsAre(HasSubstr("'mosaic' gbrg")));
    EXPECT_THAT(open(DngWriter{.pattern = {1, 0, 2, 1}}.text())->warnings(),
                ElementsAre(HasSubstr("'mosaic' grbg")));
    EXPECT_THAT(open(DngWriter{}.text(), {.fps = {}, .knows_filter = true})->warnings(), IsEmpty());
    // Of a grey camera.
    const auto grey = open(DngWriter{.photometric = 34892}.text());
    EXPECT_THAT(grey->warnings(), IsEmpty());
    EXPECT_TRUE(holds_counts(grey->read(0).image, width, height, 12));
    EXPECT_THAT([&] { open(DngWriter{.pattern_columns = 6}.text()); },
                ThrowsMessage<InputError>(HasSubstr("colour filter of 2 x 6")));
}

TEST_F(Dng, OfAFilmIsAFrameEach) {
    std::vector<std::filesystem::path> files;
    for (int i = 0; i < 3; ++i) {
        files.emplace_back(folder_ / fmt::format("f{}.dng", i));
        write_content(files.back(), DngWriter{.bits = 14, .frame = i}.text());
    }
    const auto film = open_frames(files, {});
    ASSERT_EQ(film->count(), 3);
    EXPECT_THAT(film->warnings(), ElementsAre(HasSubstr("'mosaic' rggb")));
    EXPECT_TRUE(holds_counts(film->read(2).image, width, height, 14, 2));
    // The last one is cut.
    const std::string whole = content_of(files[2]);
    write_content(files[2], whole.substr(0, whole.size() - 9));
    const auto cut = open_frames(files, {});
    EXPECT_TRUE(holds_counts(cut->read(1).image, width, height, 14, 1));
    const Frame last = cut->read(2);
    EXPECT_EQ(last.status, FrameStatus::corrupt);
    EXPECT_THAT(last.message, AllOf(HasSubstr("f2.dng"), Not(HasSubstr("no page"))));
}

// CinemaDNG specification, tag 51044.
TEST_F(Dng, OfAFilmHasItsFrameRate) {
    for (const bool is_big_endian : {false, true}) {
        for (const bool is_below : {false, true}) {
            const DngWriter writer{.is_big_endian = is_big_endian,
                                   .is_below = is_below,
                                   .rate = 24000,
                                   .rate_of = 1001};
            const auto alone = open(writer.text());
            ASSERT_TRUE(alone->frame_rate());
            EXPECT_NEAR(*alone->frame_rate(), 24000.0 / 1001, 1e-5) << "single precision";
            EXPECT_EQ(*open(writer.text(), {.fps = 500})->frame_rate(), 500);
        }
    }
    std::vector<std::filesystem::path> files;
    for (int i = 0; i < 3; ++i) {
        files.emplace_back(folder_ / fmt::format("f{}.dng", i));
        write_content(files.back(), DngWriter{.frame = i, .rate = 250}.text());
    }
    const auto film = open_frames(files, {});
    EXPECT_EQ(film->frame_rate(), 250);
    EXPECT_EQ(film->read(2).time, 2.0 / 250);
}

TEST_F(Dng, WithoutASensibleFrameRateHasNone) {
    EXPECT_EQ(open(DngWriter{}.text())->frame_rate(), std::nullopt);
    for (const auto& [rate, rate_of] : {std::pair{-25, 1}, {25, 0}, {1, 2'000'000'000}}) {
        EXPECT_EQ(open(DngWriter{.rate = rate, .rate_of = rate_of}.text())->frame_rate(),
                  std::nullopt)
            << rate << '/' << rate_of;
    }
}

TEST_F(Dng, InACompressionOfItsOwnIsRefusedWithAWayRound) {
    for (const unsigned photometric : {32803U, 34892U}) {
        for (const unsigned compression : {7U, 34892U, 52546U}) {
            EXPECT_THAT(
                [&] {
                    open(DngWriter{.photometric = photometric, .compression = compression}.text());
                },
                ThrowsMessage<InputError>(
                    AllOf(HasSubstr("shot.dng"), HasSubstr("counts of the sensor in"),
                          HasSubstr(std::to_string(compression)), HasSubstr("dcraw"))))
                << photometric << ", " << compression;
        }
    }
}

TEST_F(Dng, CutAnywhereIsRefusedByName) {
    const std::string whole = DngWriter{}.text();
    for (std::size_t cut = 1; cut < whole.size(); ++cut) {
        EXPECT_THAT([&] { open(whole.substr(0, cut)); },
                    ThrowsMessage<InputError>(HasSubstr("shot.dng")))
            << cut;
    }
}

TEST_F(Dng, WithRandomBytesChangedNeverCrashes) {
    const std::string whole = DngWriter{.rate = 25}.text();
    RandomStream random(1, "dng bytes");
    int opened = 0;
    for (int i = 0; i < 1000; ++i) {
        std::string damaged = whole;
        for (int n = 0; n < 2; ++n) {
            damaged[random.below(whole.size())] = static_cast<char>(random.below(256));
        }
        if (opens_or_is_refused(damaged, {.fps = {}, .max_pixels = 1 << 20})) ++opened;
    }
    EXPECT_GT(opened, 0);
    EXPECT_LT(opened, 1000);
}

}  // namespace
}  // namespace grainfield::io
