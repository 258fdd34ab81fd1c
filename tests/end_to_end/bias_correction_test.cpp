// `grainfield track --correct-bias`: what it says, keeps, and gives again after an interruption.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <signal.h>

#include "tests/support/fingerprint.h"
#include "tests/support/image_files.h"
#include "tests/support/program.h"
#include "tests/tracking/synthesis/rendered_layer.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::HasSubstr;
using testing::Outcome;
using testing::Process;
using testing::program;
using testing::run_grainfield;
using testing::ScratchFolder;
using testing::with;

constexpr double kScale = 12;  // a [px]
constexpr int kFrames = 24;

/// Mirror spheres that tremble about their places, 12 diameters of a bilayer.
const std::vector<std::string>& film() {
    static const ScratchFolder folder;
    static std::vector<std::string> paths;
    if (!paths.empty()) return paths;
    const testing::RenderedLayer layer = testing::rendered_layer(14, kScale, 0, 7);
    const int side = layer.brightness.width();
    tracking::MirrorImage image(side, side, kScale, 2);
    for (int i = 0; i < kFrames; ++i) {
        const auto seed = static_cast<std::uint64_t>(i);
        image.render_only(
            tracking::MirrorScene(testing::displaced(layer, 0.01, 0, seed), layer.optics));
        Image counts = image.image();
        RandomStream random(seed, "camera");
        for (float& v : counts.pixels()) {
            v = std::round(
                std::clamp(30 + 180 * v + static_cast<float>(2 * random.normal()), 0.0F, 255.0F));
        }
        paths.push_back(folder / fmt::format("frame_{:03}.png", i));
        testing::write_png(paths.back(), counts);
    }
    return paths;
}

class BiasCorrection : public ::testing::Test {
 protected:
    static std::vector<std::string> words(int frames, const std::vector<std::string>& more) {
        const std::vector<std::string> paths(film().begin(), film().begin() + frames);
        return with(with({"track", "--json", "--sphere-diameter", "12", "--threads", "2"}, more),
                    paths);
    }

    const ScratchFolder folder_;
};

TEST_F(BiasCorrection, IsSaidAndKeptWithTheCalibrationAndGivesTheSamePositionsFromThere) {
    const std::string kept = folder_ / "cal.toml";
    const Outcome first = run_grainfield(
        words(3, {"-o", folder_ / "a.h5", "--correct-bias", "--save-calibration", kept}));
    ASSERT_EQ(first.code, 0) << first.err;
    const json learned = json::parse(first.out).at("bias");
    ASSERT_TRUE(learned.is_object()) << first.err;
    EXPECT_LT(learned.at("rms_after_a"), learned.at("rms_before_a"));

    const Outcome again = run_grainfield(words(3, {"-o", folder_ / "b.h5", "--calibration", kept}));
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(json::parse(again.out).at("bias"), learned);
    EXPECT_EQ(testing::fingerprint(folder_ / "b.h5"), testing::fingerprint(folder_ / "a.h5"));

    const Outcome plain = run_grainfield(words(3, {"-o", folder_ / "c.h5"}));
    ASSERT_EQ(plain.code, 0) << plain.err;
    EXPECT_EQ(json::parse(plain.out).at("bias").at("source"), "general");
    const json stored = json::parse(run_grainfield({"info", "--json", folder_ / "c.h5"}).out);
    EXPECT_EQ(stored.at("bias"), json::parse(plain.out).at("bias"));
    EXPECT_GT(stored.at("bias").at("moved_a").get<double>(), 0);
    EXPECT_NE(testing::fingerprint(folder_ / "c.h5"), testing::fingerprint(folder_ / "a.h5"));
    const Outcome none = run_grainfield(words(3, {"-o", folder_ / "d.h5", "--no-correct-bias"}));
    ASSERT_EQ(none.code, 0) << none.err;
    EXPECT_EQ(json::parse(none.out).at("bias").at("source"), "none");
    EXPECT_THAT(run_grainfield({"info", folder_ / "d.h5"}).out,
                HasSubstr("bias         positions not corrected for mirror images: not wanted"));
    EXPECT_NE(testing::fingerprint(folder_ / "d.h5"), testing::fingerprint(folder_ / "c.h5"));

    const std::string line = fmt::format("as learned from rendered frames: {:.4f} to {:.4f} a RMS",
                                         learned.at("rms_before_a").get<double>(),
                                         learned.at("rms_after_a").get<double>());
    EXPECT_THAT(run_grainfield({"info", kept}).out, HasSubstr(line));
    EXPECT_EQ(json::parse(run_grainfield({"info", "--json", kept}).out).at("bias"), learned);
    std::vector<std::string> said =
        words(3, {"-o", folder_ / "b.h5", "--force", "--calibration", kept});
    std::erase(said, "--json");
    EXPECT_THAT(run_grainfield(said).out,
                ::testing::ContainsRegex("  bias       positions corrected for mirror images of "
                                         "neighbours as learned from rendered frames"));
    std::vector<std::string> general = words(3, {"-o", folder_ / "c.h5", "--force"});
    std::erase(general, "--json");
    EXPECT_THAT(run_grainfield(general).out,
                ::testing::ContainsRegex("  bias       positions corrected for mirror images of "
                                         "neighbours by 0\\.0[0-9]+ a RMS"));
}

TEST_F(BiasCorrection, KilledAndTakenUpAgainGivesWhatOneRunGives) {
    for (const std::vector<std::string>& kind : {{"--correct-bias"}, std::vector<std::string>()}) {
        SCOPED_TRACE(kind.empty() ? "general" : "learned");
        const std::string output = folder_ / "t.h5";
        fs::remove(output);
        const auto run = [&](const std::vector<std::string>& more) {
            return words(kFrames,
                         with(with({"-o", output, "--checkpoint-every", "0"}, kind), more));
        };
        const Outcome whole = run_grainfield(run({}));
        ASSERT_EQ(whole.code, 0) << whole.err;
        const std::string expected = testing::fingerprint(output);
        fs::remove(output);
        {
            const Process process(program(run({})));
            process.let_write(output + ".checkpoint");
            process.send(SIGKILL);
            process.wait();
        }
        ASSERT_TRUE(fs::exists(output + ".checkpoint")) << "killed too early or too late";
        const Outcome resumed = run_grainfield(run({"--resume"}));
        ASSERT_EQ(resumed.code, 0) << resumed.err;
        EXPECT_EQ(json::parse(resumed.out).at("frames"), kFrames);
        EXPECT_EQ(json::parse(resumed.out).at("bias"), json::parse(whole.out).at("bias"));
        EXPECT_EQ(testing::fingerprint(output), expected);
    }
}

}  // namespace
}  // namespace grainfield
