#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

class BadFrames : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    ScratchFolder out_;

    Outcome track(std::vector<std::string> words) {
        words.insert(words.begin(), {"track", "-o", out_ / "t.h5"});
        return run_grainfield(words);
    }

    std::string points() {
        EXPECT_EQ(run_grainfield({"export", out_ / "t.h5", "-o", out_ / "t.csv"}).code, 0);
        return testing::read_all(out_ / "t.csv");
    }

    void expect_refused(const Outcome& outcome, const std::string& name) {
        EXPECT_EQ(outcome.code, 3) << outcome.err;
        EXPECT_THAT(outcome.err, HasSubstr(name));
        EXPECT_EQ(out_.entries(), 0U);
    }
};

TEST_F(BadFrames, ATruncatedSingleImageIsRefused) {
    const Image image = testing::disc_frame(testing::few_discs(), 0);
    testing::write_png(folder_ / "cut.png", image);
    testing::write_tiff(folder_ / "cut.tif", image);
    for (const char* name : {"cut.png", "cut.tif"}) {
        ASSERT_EQ(run_grainfield({"info", folder_ / name}).code, 0) << name;
        testing::truncate_file(folder_ / name, 0.5);
        expect_refused(track({folder_ / name}), folder_ / name);
    }
}

TEST_F(BadFrames, ATruncatedImageInASequenceIsLeftOutWithItsIndexKept) {
    const auto frames = testing::write_disc_sequence(folder_, 4);
    testing::truncate_file(frames[1], 0.5);
    const Outcome outcome = track(frames);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning:"), HasSubstr("frame_001.png")));
    const std::string csv = points();
    EXPECT_EQ(csv.find("\n1,"), std::string::npos);
    EXPECT_THAT(csv, AllOf(HasSubstr("\n0,"), HasSubstr("\n2,"), HasSubstr("\n3,")));
}

TEST_F(BadFrames, StrictTurnsABadFrameIntoAFailure) {
    const auto frames = testing::write_disc_sequence(folder_, 4);
    testing::truncate_file(frames[1], 0.5);
    std::vector<std::string> words{"--strict"};
    words.insert(words.end(), frames.begin(), frames.end());
    expect_refused(track(words), "frame_001.png");
}

TEST_F(BadFrames, AMissingFileOfANumberedSequenceIsNamedAndLeavesAGap) {
    const auto frames = testing::write_disc_sequence(folder_, 4);
    const Outcome outcome = track({frames[0], frames[1], frames[3]});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning:"), HasSubstr("002")));
    const std::string csv = points();
    EXPECT_EQ(csv.find("\n2,"), std::string::npos);
    EXPECT_THAT(csv, HasSubstr("\n3,"));
}

TEST_F(BadFrames, MixedSizesAreRefusedWithTheFrame) {
    auto frames = testing::write_disc_sequence(folder_, 3);
    testing::write_png(frames[2], Image(64, 48, 200));
    const Outcome outcome = track(frames);
    expect_refused(outcome, "frame_002.png");
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("64"), HasSubstr("192")));
}

TEST_F(BadFrames, AFilmOfBlackSaturatedOrNoisyFramesIsRefusedWithTheReason) {
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

TEST_F(BadFrames, ABlackFrameAmongGoodOnesIsWarnedAbout) {
    const auto frames = testing::write_disc_sequence(folder_, 3);
    testing::write_png(frames[1], Image(testing::kPictureSize, testing::kPictureSize, 0));
    const Outcome outcome = track(frames);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning:"));
    EXPECT_THAT(outcome.err, HasSubstr("frame 1"));
}

TEST_F(BadFrames, FramesBeyondThePixelCapAreRefused) {
    const std::string frame = testing::write_disc_sequence(folder_, 1)[0];
    expect_refused(track({frame, "--max-pixels", "1000"}), frame);
}

class BadVideo : public BadFrames {
 protected:
    void SetUp() override {
        testing::write_disc_sequence(folder_, 12);
        const Outcome made = testing::shell(fmt::format(
            "ffmpeg -v error -framerate 25 -i '{0}/frame_%03d.png' -c:v ffv1 -level 3 -slicecrc 1 "
            "-g 1 '{0}/film.mkv'",
            folder_.path().string()));
        if (made.code != 0) GTEST_SKIP() << "ffmpeg is not installed";
    }
    std::string film() const { return folder_ / "film.mkv"; }
};

TEST_F(BadVideo, ATruncatedVideoKeepsItsVerifiedFramesWithAWarning) {
    testing::truncate_file(film(), 0.6);
    const Outcome outcome = track({film()});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning:"), HasSubstr("film.mkv")));
    const std::string csv = points();
    EXPECT_THAT(csv, HasSubstr("\n5,"));
    EXPECT_EQ(csv.find("\n9,"), std::string::npos);
}

TEST_F(BadVideo, AVideoCutWithinItsHeaderIsRefused) {
    fs::resize_file(film(), 100);
    expect_refused(track({film()}), film());
}

TEST_F(BadVideo, FlippedBytesLeaveAGapAndDoNotCrash) {
    {
        std::fstream file(film(), std::ios::binary | std::ios::in | std::ios::out);
        file.seekp(static_cast<std::streamoff>(fs::file_size(film()) / 2));
        file << std::string(64, '\x55');
    }
    const Outcome outcome = track({film()});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr("warning:"), HasSubstr("film.mkv")));
    const std::string csv = points();
    EXPECT_THAT(csv, AllOf(HasSubstr("\n0,"), HasSubstr("\n11,")));
}

}  // namespace
}  // namespace grainfield
