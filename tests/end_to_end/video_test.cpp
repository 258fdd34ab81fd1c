// Videos as cameras and interrupted copies make them, through the whole of `track`.
#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

using Points = std::map<int, std::vector<Vec2>>;

class Video : public ::testing::Test {
 protected:
    static constexpr int kFrames = 6;

    void SetUp() override { testing::write_disc_sequence(folder_, kFrames); }

    /// False without ffmpeg.
    bool encode(const std::string& options, const std::string& name) {
        return testing::shell(fmt::format("ffmpeg -v error -framerate 25 -i '{0}/frame_%03d.png' "
                                          "{1} '{0}/{2}'",
                                          folder_.path().string(), options, name))
                   .code == 0;
    }

    Outcome track(const std::string& name) {
        return run_grainfield({"track", "--force", "-o", folder_ / "t.h5", folder_ / name});
    }

    /// Of the last run.
    Points points() {
        EXPECT_EQ(run_grainfield({"export", "--force", "--digits", "all", folder_ / "t.h5", "-o",
                                  folder_ / "t.csv"})
                      .code,
                  0);
        std::istringstream csv(testing::read_all(folder_ / "t.csv"));
        Points found;
        for (std::string line; std::getline(csv, line);) {
            if (line.empty() || std::isdigit(static_cast<unsigned char>(line[0])) == 0) continue;
            std::istringstream fields(line);
            int frame = 0;
            int particle = 0;
            char comma = 0;
            Vec2 p;
            fields >> frame >> comma >> particle >> comma >> p.x >> comma >> p.y;
            found[frame].push_back(p);
        }
        return found;
    }

    ScratchFolder folder_;
};

TEST_F(Video, InColourIsTrackedByItsLuma) {
    // A warm lamp: R 1, G 0.8, B 0.5 of the grey picture, stored without loss.
    if (!encode("-vf format=rgb24,lutrgb=g=val*0.8:b=val*0.5 -c:v ffv1 -pix_fmt bgr0",
                "colour.mkv")) {
        GTEST_SKIP() << "ffmpeg is not installed";
    }
    ASSERT_TRUE(encode("-c:v ffv1 -pix_fmt gray", "grey.mkv"));
    ASSERT_EQ(track("grey.mkv").code, 0);
    const Points grey = points();
    const Outcome outcome = track("colour.mkv");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const Points colour = points();
    ASSERT_EQ(colour.size(), static_cast<std::size_t>(kFrames));
    // The weights of luma leave 0.83 of the contrast, rounding adds 0.3 counts of noise to 3.4:
    // 0.01 px of error of either film, of which most is common to both.
    double squares = 0;
    double n = 0;
    for (int f = 0; f < kFrames; ++f) {
        ASSERT_EQ(colour.at(f).size(), grey.at(f).size()) << f;
        EXPECT_GE(colour.at(f).size(), 120U);
        for (const Vec2 p : colour.at(f)) {
            double nearest = 100;
            for (const Vec2 q : grey.at(f)) nearest = std::min(nearest, squared_norm(p - q));
            squares += nearest / 2;
            n += 1;
        }
    }
    EXPECT_LT(std::sqrt(squares / n), 0.01);
}

TEST_F(Video, CutMidFrameGivesTheSamePositionsUpToTheCut) {
    if (!encode("-c:v ffv1 -level 3 -slicecrc 1 -g 1", "film.mkv")) {
        GTEST_SKIP() << "ffmpeg is not installed";
    }
    ASSERT_EQ(track("film.mkv").code, 0);
    const Points whole = points();
    testing::truncate_file(folder_ / "film.mkv", 0.6);
    const Outcome outcome = track("film.mkv");
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("warning:"));
    const Points cut = points();
    EXPECT_GE(cut.size(), 2U);
    EXPECT_LT(cut.size(), static_cast<std::size_t>(kFrames));
    for (const auto& [frame, positions] : cut) EXPECT_EQ(positions, whole.at(frame)) << frame;
}

}  // namespace
}  // namespace grainfield
