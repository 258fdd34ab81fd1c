#include "io/images/photron_raw.h"

#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "io/frame_files.h"
#include "io/joined_films.h"
#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr int width = 20, height = 13, frames = 4;

/// A writer of its own, from the description of the format: a stream of bits, highest first, but
/// words of 16 bit little-endian.
struct PhotronWriter {
    int bits = 12;  ///< a pixel
    int depth = 12;
    std::string side = "Lower";
    int declared = frames;
    std::string colour = "Mono";

    std::string pixels() const {
        std::string out;
        unsigned waiting = 0;
        int held = 0;
        for (int f = 0; f < frames; ++f) {
            for (int i = 0; i < width * height; ++i) {
                unsigned count = count_at(i % width, i / width, depth, f);
                if (side == "Higher") count <<= static_cast<unsigned>(bits - depth);
                if (bits == 16) {
                    out.push_back(static_cast<char>(count & 255U));
                    out.push_back(static_cast<char>(count >> 8U));
                    continue;
                }
                waiting = waiting << static_cast<unsigned>(bits) | count;
                for (held += bits; held >= 8; held -= 8) {
                    out.push_back(static_cast<char>(waiting >> static_cast<unsigned>(held - 8)));
                }
                waiting &= (1U << static_cast<unsigned>(held)) - 1U;
            }
        }
        return out;
    }
    std::string lines() const {
        return fmt::format(
            "#Camera Information Header\r\nDate : 2026/11/23\r\nCamera Type : FASTCAM Mini\r\n"
            "Record Rate(fps) : 500\r\nTotal Frame : {}\r\nImage Width : {}\r\n"
            "Image Height : {}\r\nColor Type : {}\r\nColor Bit : {}\r\nFile Format : MRaw\r\n"
            "EffectiveBit Depth : {}\r\nEffectiveBit Side : {}\r\n\r\n",
            declared, width, height, colour, bits, depth, side);
    }
    std::string xml() const {
        return std::string("\x01\0\xff preamble of the vendor\n", 26) +
               fmt::format(
                   "<cih>\n <recordInfo><recordRate>500</recordRate></recordInfo>\n"
                   " <frameInfo><totalFrame>{}</totalFrame></frameInfo>\n <imageDataInfo>\n"
                   "  <resolution><width>{}</width><height>{}</height></resolution>\n"
                   "  <colorInfo><type>{}</type><bit>{}</bit></colorInfo>\n"
                   "  <effectiveBit><depth>{}</depth><side>{}</side></effectiveBit>\n"
                   " </imageDataInfo>\n</cih>\nmore of the vendor\n",
                   declared, width, height, colour, bits, depth, side);
    }
};

class PhotronRaw : public ::testing::Test {
 protected:
    testing::ScratchFolder folder_;
    const std::string raw_ = folder_ / "film.mraw";
    const std::string header_ = folder_ / "film.cihx";
};

TEST_F(PhotronRaw, KeepsEveryBitUnderEitherHeader) {
    for (const PhotronWriter& writer :
         {PhotronWriter{.bits = 8, .depth = 8}, PhotronWriter{},
          PhotronWriter{.bits = 16, .depth = 12}, PhotronWriter{.bits = 16, .depth = 16},
          PhotronWriter{.bits = 16, .depth = 12, .side = "Higher"}}) {
        for (const bool is_xml : {true, false}) {
            const testing::ScratchFolder folder;
            write_content(folder / "film.mraw", writer.pixels());
            const std::string header = folder / (is_xml ? "film.cihx" : "film.cih");
            write_content(header, is_xml ? writer.xml() : writer.lines());
            for (const std::string& given : {folder / "film.mraw", header}) {
                const auto film = open_frames({given}, {});
                ASSERT_EQ(film->count(), frames);
                EXPECT_EQ(film->bit_depth(), writer.depth);
                EXPECT_EQ(film->frame_rate(), 500.0);
                EXPECT_TRUE(film->warnings().empty());
                for (const int f : {3, 0, 2, 1}) {
                    const Frame frame = film->read(f);
                    EXPECT_TRUE(holds_counts(frame.image, width, height, writer.depth, f))
                        << writer.bits << ", " << writer.side << ", " << is_xml;
                    EXPECT_DOUBLE_EQ(frame.time, 0.002 * f);
                }
            }
        }
    }
}

TEST_F(PhotronRaw, OfAFolderIsOneFilm) {
    write_content(raw_, PhotronWriter{}.pixels());
    write_content(header_, PhotronWriter{}.xml());
    EXPECT_EQ(recording_files({folder_.path()}), std::vector<std::filesystem::path>{raw_});
    write_content(folder_ / "film2.mraw", PhotronWriter{}.pixels());
    write_content(folder_ / "film2.cihx", PhotronWriter{}.xml());
    EXPECT_EQ(open_frames(recording_files({folder_.path()}), {})->count(), 2 * frames);
}

TEST_F(PhotronRaw, IsOneFilmWhereAPatternFindsBothItsFiles) {
    write_content(raw_, PhotronWriter{}.pixels());
    write_content(header_, PhotronWriter{}.xml());
    const auto both = recording_files({folder_ / "film.*"});
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(open_frames(both, {})->count(), frames);
    write_content(folder_ / "film.cih", PhotronWriter{}.lines());
    EXPECT_EQ(open_frames(recording_files({folder_ / "film.*"}), {})->count(), frames);
    EXPECT_EQ(open_frames({folder_ / "film.cih", header_}, {})->count(), frames);
    EXPECT_THROW(open_frames({raw_, raw_}, {}), InputError) << "one file is still given twice";
}

TEST_F(PhotronRaw, OfAColourCameraSaysSoUnlessTheFilterIsKnown) {
    write_content(raw_, PhotronWriter{}.pixels());
    for (const std::string& header :
         {PhotronWriter{.colour = "Bayer"}.xml(), PhotronWriter{.colour = "Bayer"}.lines()}) {
        write_content(header_, header);
        const auto film = open_frames({raw_}, {});
        ASSERT_EQ(film->warnings().size(), 1U);
        EXPECT_THAT(film->warnings()[0], AllOf(HasSubstr("'Bayer'"), HasSubstr("mosaic")));
        EXPECT_TRUE(open_frames({raw_}, {.fps = {}, .knows_filter = true})->warnings().empty());
    }
}

TEST_F(PhotronRaw, CutKeepsTheWholeFramesAndWarns) {
    const std::string whole = PhotronWriter{}.pixels();
    write_content(header_, PhotronWriter{}.xml());
    for (std::size_t cut = 1; cut < whole.size(); cut += 61) {
        write_content(raw_, whole.substr(0, cut));
        const std::size_t left = cut / (whole.size() / frames);
        if (left == 0) {
            EXPECT_THROW(open_frames({raw_}, {}), InputError) << cut;
            continue;
        }
        const auto film = open_frames({raw_}, {});
        ASSERT_EQ(film->count(), static_cast<std::int64_t>(left)) << cut;
        ASSERT_EQ(film->warnings().size(), 1U);
        EXPECT_TRUE(holds_counts(film->read(film->count() - 1).image, width, height, 12,
                                 static_cast<int>(left) - 1));
    }
}

TEST_F(PhotronRaw, WithADamagedHeaderNeverCrashes) {
    write_content(raw_, PhotronWriter{}.pixels());
    const std::string whole = PhotronWriter{}.xml();
    RandomStream random(1, "photron bytes");
    for (int i = 0; i < 400; ++i) {
        std::string damaged =
            whole.substr(0, i % 2 == 0 ? whole.size() : random.below(whole.size()));
        for (int n = 0; n < 3 && !damaged.empty(); ++n) {
            damaged[random.below(damaged.size())] = static_cast<char>(random.below(256));
        }
        write_content(header_, damaged);
        try {
            const auto film = open_frames({raw_}, {});
            for (std::int64_t f = 0; f < film->count(); ++f) film->read(f);
        } catch (const InputError& error) {
            EXPECT_THAT(error.what(), HasSubstr("film."));
        }
    }
}

TEST_F(PhotronRaw, ThatIsNotUnderstoodIsRefusedWithAWayRound) {
    write_content(raw_, PhotronWriter{}.pixels());
    EXPECT_THAT(
        [&] { open_frames({raw_}, {}); },
        ThrowsMessage<InputError>(AllOf(HasSubstr("header is not there"), HasSubstr("film.cihx"))));
    write_content(header_, PhotronWriter{.bits = 10, .depth = 10}.xml());
    EXPECT_THAT([&] { open_frames({raw_}, {}); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("10 bit"), HasSubstr("16-bit TIFF"))));
    write_content(header_, "<cih></cih>");
    EXPECT_THAT([&] { open_frames({raw_}, {}); },
                ThrowsMessage<InputError>(HasSubstr("resolution/width ''")));
    std::filesystem::remove(raw_);
    EXPECT_THAT([&] { open_frames({header_}, {}); },
                ThrowsMessage<InputError>(HasSubstr("frames are not there")));
    // 16 bit stored, 12 said to be used: a count above says that one of the two is wrong.
    write_content(raw_, PhotronWriter{.bits = 16, .depth = 16}.pixels());
    write_content(header_, PhotronWriter{.bits = 16, .depth = 12}.xml());
    const Frame frame = open_frames({raw_}, {})->read(0);
    EXPECT_EQ(frame.status, FrameStatus::corrupt);
    EXPECT_THAT(frame.message, HasSubstr("12 bit"));
}

}  // namespace
}  // namespace grainfield::io
