#include "io/joined_films.h"

#include <algorithm>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "io/frame_clock.h"
#include "io/frame_files.h"
#include "tests/io/picture_files.h"

namespace grainfield::io {
namespace {

using namespace picture_files;
namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

std::vector<std::string> names_of(const std::vector<fs::path>& files) {
    std::vector<std::string> names;
    for (const fs::path& file : files) names.push_back(file.filename().string());
    return names;
}

using Names = std::vector<std::string>;

TEST(Recording, OfAFolderIsItsPicturesInNaturalOrder) {
    const testing::ScratchFolder folder;
    for (const char* name : {"f10.png", "f2.png", "f1.png", ".hidden.png"}) {
        write_png(folder / name, 12, 8, 8, PNG_COLOR_TYPE_GRAY);
    }
    write_content(folder / "notes.txt", "filmed on Monday\n");
    fs::create_directory(folder / "old");
    const Names expected{"f1.png", "f2.png", "f10.png"};
    EXPECT_EQ(names_of(recording_files({folder.path()})), expected);
    EXPECT_EQ(names_of(recording_files({folder / "f*.png"})), expected) << "a pattern likewise";
    EXPECT_EQ(names_of(recording_files({folder / "f[12].png"})), (Names{"f1.png", "f2.png"}));
    const std::vector<fs::path> given{folder / "f10.png", folder / "f2.png", "absent.png"};
    EXPECT_EQ(recording_files(given), given) << "names of files stay as they are";
}

TEST(Recording, ThatIsNotOneIsRefusedByName) {
    const testing::ScratchFolder folder;
    write_content(folder / "notes.txt", "filmed on Monday\n");
    EXPECT_THAT([&] { recording_files({folder.path()}); },
                ThrowsMessage<InputError>(
                    AllOf(HasSubstr(folder.path().string()), HasSubstr("1 of *.txt"))));
    write_png(folder / "a.png", 12, 8, 8, PNG_COLOR_TYPE_GRAY);
    write_tiff(folder / "a.tif", 12, 8, {});
    EXPECT_THAT([&] { recording_files({folder.path()}); },
                ThrowsMessage<InputError>(
                    AllOf(HasSubstr("1 of *.png, 1 of *.tif"), HasSubstr("a pattern in quotes"))));
    EXPECT_THAT([&] { recording_files({folder / "b*.png"}); },
                ThrowsMessage<InputError>(HasSubstr("no file matches")));
}

// count_at(x, y, depth, frame) numbers pages from 0 in each file: the sum tells them apart.
TEST(Recording, OfStacksCountsThroughThem) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "s2.tif", 12, 8, {.pages = 3});
    write_tiff(folder / "s10.tif", 12, 8, {.pages = 1});
    write_tiff(folder / "s1.tif", 12, 8, {.pages = 2});
    const auto film =
        open_frames({folder / "s10.tif", folder / "s1.tif", folder / "s2.tif"}, {.fps = 4.0});
    ASSERT_EQ(film->count(), 6);
    const std::vector<int> page_of{0, 1, 0, 1, 2, 0};
    for (const std::int64_t at : {5, 0, 2, 4, 1, 3}) {
        const Frame frame = film->read(at);
        EXPECT_EQ(frame.index, at);
        EXPECT_DOUBLE_EQ(frame.time, 0.25 * static_cast<double>(at));
        EXPECT_TRUE(holds_counts(frame.image, 12, 8, 8, page_of[static_cast<std::size_t>(at)]))
            << at;
    }
    EXPECT_THAT(film->name(), HasSubstr("(3 parts)"));
    EXPECT_THROW(film->read(6), OptionError);
}

TEST(Recording, OfUnlikePartsIsRefusedWithBothSizes) {
    const testing::ScratchFolder folder;
    write_tiff(folder / "s1.tif", 12, 8, {.pages = 2});
    write_tiff(folder / "s2.tif", 16, 8, {.pages = 2});
    EXPECT_THAT(
        [&] {
            open_frames({folder / "s1.tif", folder / "s2.tif"}, {});
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("16 × 8"), HasSubstr("12 × 8"))));
    write_png(folder / "s3.png", 12, 8, 8, PNG_COLOR_TYPE_GRAY);
    EXPECT_THAT(
        [&] {
            open_frames({folder / "s1.tif", folder / "s3.png"}, {});
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("s3.png"), HasSubstr("TIFF"))));
    EXPECT_THROW(open_frames({folder / "s1.tif", folder / "s1.tif"}, {}), InputError);
}

/// Frames of a file that keeps time.
class StampedFrames : public FrameSource, public FrameClock {
 public:
    StampedFrames(std::int64_t count, double start, double rate)
        : count_(count), start_(start), rate_(rate) {}

    std::int64_t count() const override { return count_; }
    int width() const override { return 4; }
    int height() const override { return 4; }
    int bit_depth() const override { return 8; }
    std::optional<double> frame_rate() const override { return rate_; }
    std::string name() const override { return "stamped"; }
    const std::vector<std::string>& warnings() const override { return warnings_; }
    std::optional<FrameStamps> stamps() const override {
        return FrameStamps{start_, start_ + static_cast<double>(count_ - 1) / rate_, 1 / rate_};
    }
    Frame read(std::int64_t index) override {
        Frame frame;
        frame.index = index;
        frame.time = static_cast<double>(index) / rate_;
        frame.image = Image(4, 4, static_cast<float>(index));
        return frame;
    }

 private:
    std::int64_t count_;
    double start_, rate_;
    std::vector<std::string> warnings_;
};

struct Stretch {
    std::int64_t count;
    double start, rate;
};

std::unique_ptr<FrameSource> joined(const std::map<std::string, Stretch>& parts,
                                    std::optional<double> rate = {}) {
    std::vector<fs::path> files;
    for (const auto& [name, part] : parts) files.emplace_back(name);
    return join_parts(
        files,
        [parts](const fs::path& path) -> std::unique_ptr<FrameSource> {
            const Stretch& part = parts.at(path.string());
            return std::make_unique<StampedFrames>(part.count, part.start, part.rate);
        },
        rate);
}

TEST(Recording, WithStampsOfOneClockHasMissingFramesAtItsSeams) {
    // 3 frames from 7 s on, every 0.1 s; the next file begins at 7.5 s: 7.3 and 7.4 are absent.
    const auto film = joined({{"a1", {3, 7, 10}}, {"a2", {2, 7.5, 10}}});
    ASSERT_EQ(film->count(), 7);
    const std::vector<FrameStatus> status{
        FrameStatus::ok,      FrameStatus::ok, FrameStatus::ok, FrameStatus::missing,
        FrameStatus::missing, FrameStatus::ok, FrameStatus::ok};
    for (std::int64_t i = 0; i < 7; ++i) {
        const Frame frame = film->read(i);
        EXPECT_EQ(frame.status, status[static_cast<std::size_t>(i)]) << i;
        EXPECT_NEAR(frame.time, 0.1 * static_cast<double>(i), 1e-9) << i;
        EXPECT_EQ(frame.index, i);
    }
    ASSERT_EQ(film->warnings().size(), 1U);
    EXPECT_THAT(film->warnings()[0], AllOf(HasSubstr("2 frames are missing"), HasSubstr("a2")));
    // Filmed at 500, stamped at 10: the frames that are absent are as many.
    const auto slow = joined({{"a1", {3, 7, 10}}, {"a2", {2, 7.5, 10}}}, 500);
    EXPECT_EQ(slow->count(), 7);
    EXPECT_DOUBLE_EQ(slow->read(5).time, 0.01);
}

TEST(Recording, WithClocksOfTheirOwnGoesOnWhereTheLastPartEnded) {
    const auto film = joined({{"a1", {3, 0, 10}}, {"a2", {2, 0, 10}}});
    ASSERT_EQ(film->count(), 5);
    EXPECT_NEAR(film->read(4).time, 0.4, 1e-12);
    ASSERT_EQ(film->warnings().size(), 1U);
    EXPECT_THAT(film->warnings()[0], HasSubstr("no common clock"));
}

TEST(Recording, WhosePartsLieHoursApartIsRefused) {
    EXPECT_THAT(
        [] {
            joined({{"a1", {3, 0, 500}}, {"a2", {2, 36000, 500}}});
        },
        ThrowsMessage<InputError>(AllOf(HasSubstr("not parts of one film"),
                                        HasSubstr("10 h between 'a1' and 'a2'"),
                                        HasSubstr("track them apart"))));
}

TEST(Recording, OfTwoPartsWhoseNumbersDoNotFollowSaysSo) {
    const auto gap = joined({{"part1.mkv", {3, 0, 10}}, {"part3.mkv", {2, 0, 10}}});
    ASSERT_EQ(gap->warnings().size(), 2U);
    EXPECT_THAT(gap->warnings()[0], AllOf(HasSubstr("part1.mkv"), HasSubstr("2 apart")));
    // Stamps of one clock know better than names.
    EXPECT_TRUE(
        joined({{"part0.mkv", {3, 0, 10}}, {"part3.mkv", {2, 0.3, 10}}})->warnings().empty());
}

TEST(Recording, OfNumberedPicturesInFoldersHasMissingFramesBetweenThem) {
    const testing::ScratchFolder folder;
    std::vector<fs::path> files;
    for (const char* name : {"a/f3.png", "a/f4.png", "c/f7.png", "c/f8.png", "c/f9.png"}) {
        files.emplace_back(folder / name);
        fs::create_directories(files.back().parent_path());
        write_png(files.back().string(), 12, 8, 8, PNG_COLOR_TYPE_GRAY);
    }
    const auto film = open_frames(files, {});
    ASSERT_EQ(film->count(), 7);
    EXPECT_EQ(film->read(2).status, FrameStatus::missing);
    EXPECT_EQ(film->read(4).status, FrameStatus::ok);
    EXPECT_THAT(film->warnings().at(0), HasSubstr("2 of 7"));
    // Numbers that begin anew say nothing.
    fs::create_directory(folder / "d");
    fs::copy_file(files[0], folder / "d/f3.png");
    files.emplace_back(folder / "d/f3.png");
    const auto anew = open_frames(files, {});
    EXPECT_EQ(anew->count(), 6);
    EXPECT_THAT(anew->warnings().at(0), HasSubstr("do not go on"));
}

TEST(Recording, OfOtherRatesOrWithoutAPartSaysSo) {
    const auto film = joined({{"a1", {3, 0, 10}}, {"a3", {2, 0, 12}}});
    EXPECT_FALSE(film->frame_rate());
    EXPECT_EQ(film->read(4).time, 4) << "in frames";
    const auto found = [&](const char* text) {
        return std::ranges::any_of(film->warnings(), [&](const std::string& warning) {
            return warning.find(text) != std::string::npos;
        });
    };
    EXPECT_TRUE(found("12 a second"));
    const auto gap = joined({{"a1", {3, 0, 10}}, {"a2", {1, 0, 10}}, {"a4", {2, 0, 10}}});
    ASSERT_EQ(gap->warnings().size(), 2U);
    EXPECT_THAT(gap->warnings()[0], HasSubstr("'a3' is not there"));
}

TEST(Recording, OfManyPartsIsReadInAnyOrder) {
    std::map<std::string, Stretch> parts;
    for (int i = 10; i < 60; ++i) parts[fmt::format("p{}", i)] = {2, 0, 10};
    const auto film = joined(parts);
    ASSERT_EQ(film->count(), 100);
    for (std::int64_t i = 0; i < 300; ++i) {
        const std::int64_t at = (i * 37) % 100;
        EXPECT_EQ(film->read(at).image(0, 0), static_cast<float>(at % 2));
    }
}

}  // namespace
}  // namespace grainfield::io
