#include <algorithm>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

/// A small cell, its snapshots a tenth of a period apart.
class Render : public ::testing::Test {
 protected:
    ScratchFolder folder_;
    std::string layer_ = folder_ / "md.h5";

    void SetUp() override { simulate("1.5"); }

    void simulate(const std::string& periods) const {
        const Outcome outcome = run_grainfield(
            {"simulate", "md", "-o", layer_, "--grains", "90", "--length-x", "10", "--length-y",
             "10", "--periods", periods, "--discard", "1", "--snapshot-every", "0.1", "--force"});
        ASSERT_EQ(outcome.code, 0) << outcome.err;
    }

    std::vector<std::string> call(const std::string& output, std::vector<std::string> more = {},
                                  int side = 120) const {
        const std::string pixels = fmt::format("{}", side);
        std::vector<std::string> words{"render", layer_,     "-o",   output,    "--width",
                                       pixels,   "--height", pixels, "--scale", "12"};
        words.insert(words.end(), more.begin(), more.end());
        return words;
    }
};

/// All files of a folder, in order.
std::string bytes_in(const std::string& folder) {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end());
    std::string bytes;
    for (const auto& path : paths) bytes += path.filename().string() + testing::read_all(path);
    return bytes;
}

std::string as_csv(const ScratchFolder& folder, const std::string& file) {
    const std::string points = folder / "points.csv";
    EXPECT_EQ(run_grainfield({"export", file, "-o", points, "--force"}).code, 0);
    return testing::read_all(points);
}

TEST_F(Render, ThreadsDoNotChangeAByte) {
    for (const char* optics : {"silhouette", "raytrace"}) {
        std::vector<std::string> frames;
        std::vector<std::string> truths;
        for (const char* threads : {"1", "2"}) {
            const std::string name = std::string(optics) + threads;
            const Outcome outcome =
                run_grainfield(call(folder_ / name,
                                    {"--optics", optics, "--threads", threads, "--most-frames", "2",
                                     "--truth", folder_ / (name + ".h5")},
                                    60));
            ASSERT_EQ(outcome.code, 0) << outcome.err;
            frames.push_back(bytes_in(folder_ / name));
            truths.push_back(as_csv(folder_, folder_ / (name + ".h5")));
        }
        EXPECT_EQ(frames[0], frames[1]) << optics;
        EXPECT_EQ(truths[0], truths[1]) << optics;
        EXPECT_GT(frames[0].size(), 2 * 60U * 60U);
    }
}

TEST_F(Render, RayTracingSaysWhatItSavedAndThatNobodySeesIt) {
    const Outcome outcome = run_grainfield(
        call(folder_ / "f", {"--optics", "raytrace", "--most-frames", "1", "--json"}));
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json summary = json::parse(outcome.out);
    EXPECT_EQ(summary["frames"], 1);
    EXPECT_GT(summary["rays_per_pixel"], 4);
    EXPECT_GT(summary["samples_per_pixel"], 1);
    EXPECT_GT(summary["rays_saved"], 0.1);
    EXPECT_LT(summary["rays_saved"], 1);
    EXPECT_GT(summary["settled_pixels"], 0.02);
    EXPECT_GT(summary["sampling_difference"], 0);
    EXPECT_LT(summary["sampling_difference"], summary["camera_noise"]);
    EXPECT_THAT(outcome.err, HasSubstr("rendering 0/1 frames")) << "slow: progress from the start";

    const Outcome words =
        run_grainfield(call(folder_ / "g", {"--optics", "raytrace", "--most-frames", "1"}));
    EXPECT_THAT(words.out,
                AllOf(HasSubstr("rays a pixel of the frame"),
                      HasSubstr("fewer than by uniform sampling"), HasSubstr("camera noise")));
    const Outcome plan = run_grainfield(call(folder_ / "h", {"--optics", "raytrace", "--explain"}));
    EXPECT_EQ(plan.code, 0) << plan.err;
    EXPECT_THAT(plan.out, AllOf(HasSubstr("ray tracing, 120"), HasSubstr("uniform sampling"),
                                HasSubstr("one where neighbours agree")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "h"));
}

TEST_F(Render, ABadValueEndsWithTwoAndNamesWhatIsAllowed) {
    const Outcome optics = run_grainfield(call(folder_ / "f", {"--optics", "wave"}));
    EXPECT_EQ(optics.code, 2);
    EXPECT_THAT(optics.err, AllOf(HasSubstr("wave"), HasSubstr("silhouette, raytrace")));
    const Outcome bits = run_grainfield(call(folder_ / "f", {"--bits", "9"}));
    EXPECT_EQ(bits.code, 2);
    EXPECT_THAT(bits.err, HasSubstr("8, 10, 12 or 16"));
    const Outcome rate = run_grainfield(call(folder_ / "f", {"--frame-rate", "1e6"}));
    EXPECT_EQ(rate.code, 2);
    EXPECT_THAT(rate.err, HasSubstr("too few snapshots"));
    EXPECT_THAT(rate.err, HasSubstr("leave out --frame-rate"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "f"));
}

TEST_F(Render, WithoutHeightsAndLayersItWarnsAndGoesOn) {
    const auto frames = testing::write_disc_sequence(folder_, 2);
    ASSERT_EQ(run_grainfield({"track", frames[0], frames[1], "-o", folder_ / "flat.h5"}).code, 0);
    const Outcome outcome = run_grainfield(
        {"render", folder_ / "flat.h5", "-o", folder_ / "f", "--width", "100", "--height", "80"});
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("neither heights nor layers"));
    EXPECT_THAT(outcome.err, HasSubstr("no clock"));
}

TEST_F(Render, AnEmptyTrajectoryEndsWithThree) {
    simulate("0.5");  // all of it discarded
    const Outcome outcome = run_grainfield(call(folder_ / "f"));
    EXPECT_EQ(outcome.code, 3) << outcome.err;
    EXPECT_THAT(outcome.err, AllOf(HasSubstr(layer_), HasSubstr("holds no frames")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "f"));
}

TEST_F(Render, FramesWithoutAnySphereAreMadeWithAWarning) {
    const std::string walls = folder_ / "walls.h5";
    ASSERT_EQ(run_grainfield({"simulate", "md", "-o", walls, "--grains", "60", "--length-x", "10",
                              "--length-y", "10", "--sides-x", "walls", "--sides-y", "walls",
                              "--periods", "1", "--snapshot-every", "0.5"})
                  .code,
              0);
    const Outcome empty = run_grainfield({"render", walls, "-o", folder_ / "g", "--width", "64",
                                          "--height", "64", "--scale", "8", "--centre-x", "100",
                                          "--truth", folder_ / "t.h5", "--json"});
    EXPECT_EQ(empty.code, 0) << empty.err;
    const json summary = json::parse(empty.out);
    EXPECT_EQ(summary["particles_mean"], 0);
    EXPECT_GT(summary["frames"], 0);
    EXPECT_THAT(empty.err, HasSubstr("no sphere is in view"));
}

TEST_F(Render, AFullDiskOrAPlaceThatCannotBeWrittenEndsWithFour) {
    std::string line = "trap '' XFSZ; ulimit -f 8; exec \"$GRAINFIELD\"";
    for (const std::string& word : call(folder_ / "f")) line += " '" + word + "'";
    const Outcome full = testing::shell(line);
    EXPECT_EQ(full.code, 4) << full.err;
    EXPECT_THAT(full.err, HasSubstr(folder_ / "f"));
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "f")) {
        ADD_FAILURE() << entry.path() << " is a picture that was not completed";
    }
    const Outcome refused = run_grainfield(call("/proc/frames"));
    EXPECT_EQ(refused.code, 4) << refused.err;
    EXPECT_THAT(refused.err, HasSubstr("/proc/frames"));
    const Outcome truth =
        run_grainfield(call(folder_ / "h", {"--truth", folder_ / "missing/t.h5"}));
    EXPECT_EQ(truth.code, 4) << truth.err;
}

TEST_F(Render, CtrlCKeepsTheFramesDone) {
    simulate("200");
    auto words = call(folder_ / "f", {"--truth", folder_ / "t.h5", "--optics", "raytrace"}, 60);
    words.insert(words.begin(), GRAINFIELD_PROGRAM);
    const testing::Process process(words);
    process.let_work(std::chrono::seconds(3), SIGINT);
    process.send(SIGINT);
    const Outcome outcome = process.wait();
    EXPECT_EQ(outcome.code, 130) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("which are kept"));
    std::size_t pictures = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "f")) {
        EXPECT_EQ(entry.path().extension(), ".tif");
        ++pictures;
    }
    EXPECT_GT(pictures, 0U);
    const Outcome info = run_grainfield({"info", folder_ / "t.h5", "--json"});
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_THAT(info.out, HasSubstr(fmt::format("{}", pictures)));
    std::vector<std::string> track{"track", "-o", folder_ / "tracks.h5"};
    track.push_back(folder_ / "f/frame-000000.tif");
    EXPECT_EQ(run_grainfield(track).code, 0) << "a whole picture";
}

}  // namespace
}  // namespace grainfield
