// Recordings as they lie on the disk: folders, patterns, stacks, split videos, raw colour frames.

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/csv_rows.h"
#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

class Recording : public ::testing::Test {
 protected:
    static constexpr int kFrames = 6;

    Outcome track(const std::vector<std::string>& film, std::vector<std::string> more = {}) {
        std::vector<std::string> words{"track", "--force", "-o", out_ / "t.h5"};
        words.insert(words.end(), more.begin(), more.end());
        words.insert(words.end(), film.begin(), film.end());
        return run_grainfield(words);
    }

    /// The last run: frames, identities and positions.
    std::string points() {
        EXPECT_EQ(run_grainfield(
                      {"export", "--force", "--digits", "all", out_ / "t.h5", "-o", out_ / "t.csv"})
                      .code,
                  0);
        const std::string text = testing::read_all(out_ / "t.csv");
        return text.substr(text.find("frame,"));
    }

    bool encode(const std::string& options) {
        return testing::shell(fmt::format("ffmpeg -v error -framerate 25 -i '{0}/frame_%03d.png' "
                                          "-c:v ffv1 -pix_fmt gray {1}",
                                          film_.path().string(), options))
                   .code == 0;
    }

    ScratchFolder film_, out_;
    std::vector<std::string> frames_ = testing::write_disc_sequence(film_, kFrames);
};

TEST_F(Recording, AFolderAndAPatternAreTheirFilesInOrder) {
    ASSERT_EQ(track(frames_).code, 0);
    const std::string expected = points();
    const Outcome folder = track({film_.path().string()});
    ASSERT_EQ(folder.code, 0) << folder.err;
    EXPECT_EQ(points(), expected);
    const Outcome pattern = track({film_ / "frame_*.png"});
    ASSERT_EQ(pattern.code, 0) << pattern.err;
    EXPECT_EQ(points(), expected);
    const Outcome none = track({film_ / "image_*.png"});
    EXPECT_EQ(none.code, 3);
    EXPECT_THAT(none.err, HasSubstr("no file matches"));
    const Outcome info = run_grainfield({"info", film_.path().string(), "--json"});
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_EQ(nlohmann::json::parse(info.out)["frames"], kFrames);
}

TEST_F(Recording, IdentitiesGoOnAcrossTheSeamsOfASplitVideo) {
    if (!encode(fmt::format("'{}'", out_ / "whole.mkv"))) GTEST_SKIP() << "ffmpeg is not installed";
    const std::string segments = out_ / "part%d.mkv";
    ASSERT_TRUE(encode(fmt::format("-g 1 -f segment -segment_time 0.08 '{}'", segments)));
    ASSERT_TRUE(std::filesystem::exists(out_ / "part2.mkv")) << "three parts of two frames";
    ASSERT_EQ(track({out_ / "whole.mkv"}).code, 0);
    const std::string whole = points();
    const Outcome split = track({out_ / "part*.mkv"});
    ASSERT_EQ(split.code, 0) << split.err;
    EXPECT_THAT(split.out, AllOf(HasSubstr("6 frames"), HasSubstr("25 frames a second, from the "
                                                                  "file: is that the filming")));
    EXPECT_EQ(points(), whole);
    ASSERT_EQ(track({out_ / "whole.mkv"}, {"--frames", "1:5"}).code, 0);
    const std::string some = points();
    ASSERT_EQ(track({out_ / "part*.mkv"}, {"--frames", "1:5"}).code, 0);
    EXPECT_EQ(points(), some) << "frames are counted through the parts";
}

/// Red light on a sensor behind RGGB: green and blue see a tenth of it.
Image behind_filter(const Image& grey) {
    Image mosaic = grey;
    for (int y = 0; y < grey.height(); ++y) {
        for (int x = 0; x < grey.width(); ++x) {
            const bool is_red = x % 2 == 0 && y % 2 == 0;
            mosaic(x, y) = is_red ? grey(x, y) : 0.1F * grey(x, y);
        }
    }
    return mosaic;
}

// Bilinear red pixels, one in four, leave twice the error of grey frames, 0.02 px, and less than
// 0.03 px of their grid.
TEST_F(Recording, RawFramesOfAColourCameraAreTrackedInTheChannelOfMostContrast) {
    const testing::LayerScene scene = testing::few_discs();
    testing::write_png(out_ / "raw.png", behind_filter(testing::disc_frame(scene, 0)));
    const Outcome outcome =
        track({out_ / "raw.png"}, {"--mosaic", "rggb", "--channel", "best", "-v"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out,
                HasSubstr("RGGB → red, interpolated: it has the most contrast (red 1"));
    points();
    double squares = 0, found = 0;
    for (auto& row : testing::csv_rows(out_ / "t.csv")) {
        const Vec2 p{std::stod(row["x"]), std::stod(row["y"])};
        double nearest = 1e9;
        for (const Vec2 q : scene.position) nearest = std::min(nearest, squared_norm(p - q));
        squares += nearest / 2;
        found += 1;
    }
    EXPECT_GE(found, 120);
    EXPECT_LT(std::sqrt(squares / found), 0.05);
    const Outcome grey = track({frames_[0]}, {"--channel", "best"});
    EXPECT_EQ(grey.code, 2);
    EXPECT_THAT(grey.err, HasSubstr("--mosaic"));
}

}  // namespace
}  // namespace grainfield
