// Cases 2 to 10 of docs/reliability.md: films and pictures.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <png.h>
#include <sys/resource.h>

#include "core/support/random.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

class BadFrames : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    ScratchFolder out_;
    const std::string film_ = folder_ / "film.mkv";

    Outcome track(std::vector<std::string> words) {
        words.insert(words.begin(), {"track", "-o", out_ / "t.h5"});
        return run_grainfield(words);
    }

    std::string points() {
        const Outcome outcome = run_grainfield(
            {"export", out_ / "t.h5", "-o", out_ / "t.csv", "--force", "--digits", "all"});
        EXPECT_EQ(outcome.code, 0) << outcome.err;
        return testing::read_all(out_ / "t.csv");
    }

    /// The numbers of the frames in which something was found.
    std::vector<int> frames_found() {
        std::vector<int> found;
        const std::string csv = points();
        for (std::size_t at = csv.find("frame,"); at != std::string::npos;
             at = csv.find('\n', at + 1)) {
            if (at + 1 >= csv.size() || csv[at + 1] < '0' || csv[at + 1] > '9') continue;
            const int frame = std::stoi(csv.substr(at + 1, 9));
            if (found.empty() || found.back() != frame) found.push_back(frame);
        }
        return found;
    }

    /// A film of the pictures of the folder; false without ffmpeg.
    bool encode(const std::string& options, const std::string& name) const {
        return testing::shell(fmt::format("ffmpeg -v error -y -framerate 25 -i "
                                          "'{0}/frame_%03d.png' {1} '{0}/{2}'",
                                          folder_.path().string(), options, name))
                   .code == 0;
    }

    /// film_: twelve frames with checksums. False without ffmpeg.
    bool make_film() const {
        testing::write_disc_sequence(folder_, 12);
        return encode("-c:v ffv1 -level 3 -slicecrc 1 -g 1", "film.mkv");
    }

    void expect_refused(const Outcome& outcome, const std::string& name) {
        EXPECT_EQ(outcome.code, 3) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(name));
        EXPECT_EQ(out_.entries(), 0U);
    }
};

using Case02 = BadFrames;
using Case03 = BadFrames;
using Case04 = BadFrames;
using Case05 = BadFrames;
using Case06 = BadFrames;
using Case07 = BadFrames;
using Case08 = BadFrames;
using Case09 = BadFrames;
using Case10 = BadFrames;

TEST_F(Case02, ATruncatedSingleImageIsRefused) {
    const Image image = testing::disc_frame(testing::few_discs(), 0);
    testing::write_png(folder_ / "cut.png", image);
    testing::write_tiff(folder_ / "cut.tif", image);
    for (const char* name : {"cut.png", "cut.tif"}) {
        ASSERT_EQ(run_grainfield({"info", folder_ / name}).code, 0) << name;
        testing::truncate_file(folder_ / name, 0.5);
        expect_refused(track({folder_ / name}), folder_ / name);
    }
}

TEST_F(Case02, ATruncatedImageInASequenceIsLeftOutWithItsIndexKept) {
    const auto frames = testing::write_disc_sequence(folder_, 4);
    testing::truncate_file(frames[1], 0.5);
    const Outcome outcome = track(frames);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning:"), HasSubstr("frame_001.png")));
    const std::string csv = points();
    EXPECT_EQ(csv.find("\n1,"), std::string::npos);
    EXPECT_THAT(csv, AllOf(HasSubstr("\n0,"), HasSubstr("\n2,"), HasSubstr("\n3,")));
}

TEST_F(Case03, StrictTurnsABadFrameIntoAFailure) {
    const auto frames = testing::write_disc_sequence(folder_, 4);
    testing::truncate_file(frames[1], 0.5);
    std::vector<std::string> words{"--strict"};
    words.insert(words.end(), frames.begin(), frames.end());
    expect_refused(track(words), "frame_001.png");
}

TEST_F(Case04, AMissingFileOfANumberedSequenceIsNamedAndLeavesAGap) {
    const auto frames = testing::write_disc_sequence(folder_, 4);
    const Outcome outcome = track({frames[0], frames[1], frames[3]});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning:"), HasSubstr("002")));
    const std::string csv = points();
    EXPECT_EQ(csv.find("\n2,"), std::string::npos);
    EXPECT_THAT(csv, HasSubstr("\n3,"));
}

/// 16 bits, big-endian as PGM wants them: the counts of `image` and `offset` more.
void write_pgm16(const std::string& path, const Image& image, unsigned offset) {
    std::ofstream file(path, std::ios::binary);
    file << fmt::format("P5\n{} {}\n65535\n", image.width(), image.height());
    for (const std::uint8_t byte : testing::bytes_of(image)) {
        const unsigned count = byte + offset;
        file.put(static_cast<char>(count >> 8U)).put(static_cast<char>(count & 0xffU));
    }
}

TEST_F(Case05, AnotherSizeOrDepthIsRefusedWithTheFrame) {
    auto frames = testing::write_disc_sequence(folder_, 3);
    testing::write_png(frames[2], Image(64, 48, 200));
    const Outcome size = track(frames);
    expect_refused(size, "frame_002.png");
    EXPECT_THAT(size.err, AllOf(HasSubstr("64"), HasSubstr("192")));
    frames[2] = folder_ / "frame_002.pgm";
    write_pgm16(frames[2], testing::disc_frame(testing::few_discs(), 2), 0);
    const Outcome depth = track(frames);
    expect_refused(depth, "frame_002.pgm");
    EXPECT_THAT(depth.err, AllOf(HasSubstr("16"), HasSubstr("8")));
}

// The counts differ in their last eight bits only: a reader that drops them sees no disc at all.
TEST_F(Case06, SixteenBitsAreReadAtFullDepthAndBitExactlyInEveryFormat) {
    const Image image = testing::disc_frame(testing::few_discs(), 0);
    testing::write_png(folder_ / "eight.png", image);
    ASSERT_EQ(track({folder_ / "eight.png", "--force"}).code, 0);
    const std::string all = points();
    const std::string expected = all.substr(all.find("frame,"));
    write_pgm16(folder_ / "a.pgm", image, 256 * 117);
    std::vector<std::string> found;
    for (const char* name : {"a.pgm", "b.png", "c.tif", "d.mkv"}) {
        const bool is_film = std::string(name).ends_with("mkv");
        if (testing::shell(fmt::format("cd '{}' && ffmpeg -v error -y -i a.pgm {} {}",
                                       folder_.path().string(),
                                       is_film ? "-c:v ffv1 -pix_fmt gray16le" : "-update 1",
                                       std::string(name) == "a.pgm" ? "z.png" : name))
                .code != 0) {
            GTEST_SKIP() << "ffmpeg is not installed";
        }
        const Outcome info = run_grainfield({"info", folder_ / name, "--json"});
        EXPECT_EQ(nlohmann::json::parse(info.out)["bit_depth"], 16) << info.out;
        const Outcome outcome = track({folder_ / name, "--force"});
        ASSERT_EQ(outcome.code, 0) << name << outcome.err;
        const std::string csv = points();
        found.push_back(csv.substr(csv.find("frame,")));
    }
    for (const std::string& csv : found) EXPECT_EQ(csv, found[0]);
    EXPECT_EQ(std::ranges::count(found[0], '\n'), std::ranges::count(expected, '\n'))
        << "as many discs as with eight bits";
}

// By the contract of the program one picture needs no option, and pictures have no clock. So no
// rate is asked for: what it makes is in frames, and says so; a wrong rate is no rate.
TEST_F(Case07, WithoutAFrameRateTimesAreInFramesAndAWarningSaysSo) {
    const auto frames = testing::write_disc_sequence(folder_, 6);
    const Outcome outcome = track(frames);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning: times are in frames: the frame rate is not known; "
                                       "give --fps"));
    const auto first_lag = [&](const std::vector<std::string>& more) {
        const Outcome analysis =
            run_grainfield(testing::with({"analyze", out_ / "t.h5", "-o", out_ / "r.h5",
                                          "--observables", "msd", "--lags", "all", "--force"},
                                         more));
        EXPECT_EQ(analysis.code, 0) << analysis.err;
        EXPECT_EQ(run_grainfield({"export", out_ / "r.h5", "-o", out_ / "c", "--force"}).code, 0);
        const std::string csv = testing::read_all(out_ / "c/msd.csv");
        const std::string units = testing::read_all(out_ / "c/units.csv");
        const std::size_t line = csv.find('\n') + 1;
        const std::size_t time = units.find("msd,t,") + 6;
        return csv.substr(line, csv.find(',', line) - line) + " " +
               units.substr(time, units.find_first_of(",\n", time) - time);
    };
    EXPECT_EQ(first_lag({}), "1 frames");
    EXPECT_EQ(first_lag({"--fps", "25"}), "0.04 s");
    const Outcome given = track(testing::with({"--fps", "25", "--force"}, frames));
    ASSERT_EQ(given.code, 0) << given.err;
    EXPECT_THAT(given.err, Not(HasSubstr("times are in frames")));
    EXPECT_EQ(first_lag({}), "0.04 s");
    for (const char* wrong : {"0", "-25", "nan", "inf", "25 per second"}) {
        EXPECT_EQ(track({"--fps", wrong, frames[0], "--force"}).code, 2) << wrong;
    }
    const Outcome one = track({frames[0], "--force"});
    EXPECT_THAT(one.err, Not(HasSubstr("times are in frames"))) << "one picture has no times";
}

/// Exchanges two stamps [ms, below 256] of a Matroska film with one frame a cluster.
void swap_stamps(const std::string& path, int one, int other) {
    std::string film = testing::read_all(path);
    int swapped = 0;
    for (std::size_t at = film.find("\x1f\x43\xb6\x75"); at != std::string::npos;
         at = film.find("\x1f\x43\xb6\x75", at + 4)) {
        // The stamp is the first element of a cluster: E7, length 1.
        const std::size_t stamp = film.find("\xe7\x81", at) + 2;
        if (stamp > at + 20) continue;
        const int is = static_cast<unsigned char>(film[stamp]);
        if (is != one && is != other) continue;
        film[stamp] = static_cast<char>(is == one ? other : one);
        ++swapped;
    }
    EXPECT_EQ(swapped, 2);
    std::ofstream(path, std::ios::binary) << film;
}

// Discs drift by |v|² = 0.13 px² a frame². Frames 5 and 6 lie in the file in the wrong order, with
// their stamps: by stamps the mean squared displacement after one interval is 0.13 px², by the
// order in the file (7 · 1 + 4 + 1 + 4)/10 of it. A position is good to 0.01 px: 10 %.
TEST_F(Case08, TimeStampsThatGoBackAreWarnedOfAndTheMsdUsesThem) {
    const testing::LayerScene start = testing::few_discs();
    for (int i = 0; i < 11; ++i) {
        const int shown = i == 5 ? 6 : i == 6 ? 5 : i;
        testing::write_png(folder_ / fmt::format("frame_{:03}.png", i),
                           testing::disc_frame(start, shown));
    }
    if (!encode("-c:v ffv1 -g 1", "film.mkv")) GTEST_SKIP() << "ffmpeg is not installed";
    swap_stamps(folder_ / "film.mkv", 200, 240);
    const Outcome outcome = track({folder_ / "film.mkv"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning:"), HasSubstr("do not increase at frame 6")));
    const Outcome analysis =
        run_grainfield({"analyze", out_ / "t.h5", "-o", out_ / "r.h5", "--diameter", "1",
                        "--observables", "msd", "--lags", "all"});
    ASSERT_EQ(analysis.code, 0) << analysis.err;
    ASSERT_EQ(run_grainfield({"export", out_ / "r.h5", "-o", out_ / "c"}).code, 0);
    const std::string csv = testing::read_all(out_ / "c/msd.csv");
    const std::size_t row = csv.find("\n0.04,all,");
    ASSERT_NE(row, std::string::npos) << csv;
    EXPECT_NEAR(std::stod(csv.substr(row + 10)), 0.13, 0.013);
}

TEST_F(Case09, AFilmOfBlackSaturatedOrNoisyFramesIsRefusedWithTheReason) {
    Image noise(128, 128, 100);
    RandomStream random(1, "noise only");
    for (float& pixel : noise.pixels()) pixel += static_cast<float>(2 * random.normal());
    testing::write_png(folder_ / "black.png", Image(128, 128, 0));
    testing::write_png(folder_ / "saturated.png", Image(128, 128, 255));
    testing::write_png(folder_ / "noise.png", noise);
    for (const char* name : {"black.png", "saturated.png", "noise.png"}) {
        const Outcome outcome = track({folder_ / name});
        EXPECT_EQ(outcome.code, 3) << name << ": " << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr("warning:")) << name;
        EXPECT_THAT(outcome.err, HasSubstr("no spheres to track")) << name;
        EXPECT_FALSE(std::filesystem::exists(out_ / "t.h5")) << name;
    }
}

TEST_F(Case09, ABlackFrameAmongGoodOnesIsWarnedAbout) {
    const auto frames = testing::write_disc_sequence(folder_, 3);
    testing::write_png(frames[1], Image(testing::kPictureSize, testing::kPictureSize, 0));
    const Outcome outcome = track(frames);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning:"));
    EXPECT_THAT(outcome.err, HasSubstr("frame 1"));
}

/// 20,000 × 20,000 pixels of one bit in some 50 kB.
void write_bomb(const std::string& path) {
    constexpr unsigned side = 20000;
    std::FILE* file = std::fopen(path.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, side, side, 1, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE,
                 PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    const std::vector<std::uint8_t> row(side / 8);
    for (unsigned y = 0; y < side; ++y) png_write_row(png, row.data());
    png_write_end(png, nullptr);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
}

TEST_F(Case10, APictureThatUnpacksBeyondThePixelCapIsRefused) {
    const std::string bomb = folder_ / "bomb.png";
    write_bomb(bomb);
    ASSERT_LT(fs::file_size(bomb), 200000U);
    // Refused by its size: it is not unpacked for it, to 1.6 GB.
    const Outcome by_size = track({bomb});
    expect_refused(by_size, bomb);
    EXPECT_THAT(by_size.err, HasSubstr("20000 × 20000"));
    rusage used{};
    getrusage(RUSAGE_CHILDREN, &used);
    EXPECT_LT(used.ru_maxrss, 500000) << "kB";
    const std::string frame = testing::write_disc_sequence(folder_, 1)[0];
    const Outcome outcome = track({frame, "--max-pixels", "1000"});
    expect_refused(outcome, frame);
    EXPECT_THAT(outcome.err, HasSubstr("--max-pixels"));
}

TEST_F(Case02, ATruncatedVideoKeepsItsVerifiedFramesAndTheirTrueNumberWithAWarning) {
    if (!make_film()) GTEST_SKIP() << "ffmpeg is not installed";
    testing::truncate_file(film_, 0.6);
    const Outcome outcome = track({film_, "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err,
                AllOf(HasSubstr("warning:"), HasSubstr("film.mkv"), HasSubstr("cut short")));
    const std::vector<int> found = frames_found();
    EXPECT_GE(found.size(), 6U);
    EXPECT_LE(found.size(), 7U) << "0.6 of twelve";
    EXPECT_EQ(found.back(), static_cast<int>(found.size()) - 1);
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["frames"], found.size());
}

TEST_F(Case02, AVideoCutWithinItsHeaderIsRefused) {
    if (!make_film()) GTEST_SKIP() << "ffmpeg is not installed";
    fs::resize_file(film_, 100);
    expect_refused(track({film_}), film_);
}

TEST_F(Case03, ACorruptFrameInTheMiddleIsFlaggedAndLeavesAGapThatTracksBridge) {
    if (!make_film()) GTEST_SKIP() << "ffmpeg is not installed";
    {
        std::fstream file(film_, std::ios::binary | std::ios::in | std::ios::out);
        file.seekp(static_cast<std::streamoff>(fs::file_size(film_) / 2));
        file << std::string(64, '\x55');
    }
    const Outcome outcome = track({film_, "--json"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning:"), HasSubstr("film.mkv")));
    const std::vector<int> found = frames_found();
    ASSERT_EQ(found.size(), 11U) << "all but one";
    int missing = 0;
    while (found[static_cast<std::size_t>(missing)] == missing) ++missing;
    EXPECT_GE(missing, 4);
    EXPECT_LE(missing, 7) << "in the middle";
    EXPECT_EQ(found.back(), 11) << "the others keep their numbers";
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["frames_corrupt"], 1);
    EXPECT_THAT(outcome.err, HasSubstr(fmt::format("frame {}", missing)));
    // As many identities as discs: the same before and after the gap.
    const std::string csv = points();
    EXPECT_EQ(csv.find(fmt::format("\n11,{},", testing::few_discs().position.size())),
              std::string::npos);
}

}  // namespace
}  // namespace grainfield
