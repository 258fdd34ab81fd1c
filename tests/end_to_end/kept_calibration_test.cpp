// `grainfield track --save-calibration` and `--calibration`: films of a series measured alike.
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

using ::testing::HasSubstr;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

Outcome track(const std::vector<std::string>& frames, std::vector<std::string> words) {
    words.insert(words.begin(), "track");
    words.insert(words.end(), frames.begin(), frames.end());
    return run_grainfield(words);
}

std::string positions(const std::string& file) {
    EXPECT_EQ(run_grainfield({"export", file, "-o", file + ".csv", "--digits", "all"}).code, 0);
    return testing::read_all(file + ".csv");
}

class KeptCalibration : public ::testing::Test {
 protected:
    void SetUp() override {
        frames_ = testing::write_disc_sequence(folder_, 3);
        const Outcome kept =
            track(frames_, {"-o", folder_ / "a.h5", "--save-calibration", folder_ / "cal.toml"});
        ASSERT_EQ(kept.code, 0) << kept.err;
    }

    void change(const std::string& from, const std::string& to) {
        std::string text = testing::read_all(folder_ / "cal.toml");
        const auto at = text.find(from);
        ASSERT_NE(at, std::string::npos);
        text.replace(at, from.size(), to);
        std::ofstream(folder_ / "changed.toml") << text;
    }

    Outcome track_changed() {
        return track(frames_, {"-o", folder_ / "c.h5", "--calibration", folder_ / "changed.toml"});
    }

    const ScratchFolder folder_;
    std::vector<std::string> frames_;
};

TEST_F(KeptCalibration, ANameThatIsTakenIsRefusedBeforeTheWork) {
    const Outcome taken =
        track(frames_, {"-o", folder_ / "d.h5", "--save-calibration", folder_ / "cal.toml"});
    EXPECT_EQ(taken.code, 4);
    EXPECT_THAT(taken.err, HasSubstr("cal.toml"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "d.h5"));
}

TEST_F(KeptCalibration, OfACompleteRunIsNoObstacleToItsRepetition) {
    const Outcome again = track(
        frames_, {"-o", folder_ / "a.h5", "--save-calibration", folder_ / "cal.toml", "--resume"});
    EXPECT_EQ(again.code, 0) << again.err;
}

TEST_F(KeptCalibration, GivesTheSamePositionsToTheBit) {
    const Outcome again =
        track(frames_, {"-o", folder_ / "b.h5", "--calibration", folder_ / "cal.toml"});
    ASSERT_EQ(again.code, 0) << again.err;
    EXPECT_EQ(positions(folder_ / "b.h5"), positions(folder_ / "a.h5"));
    EXPECT_EQ(again.err.find("kept calibration"), std::string::npos) << again.err;
}

TEST_F(KeptCalibration, APartOfTheFilmIsMeasuredByIt) {
    const Outcome part = track(
        {frames_[2]}, {"--json", "-o", folder_ / "b.h5", "--calibration", folder_ / "cal.toml"});
    ASSERT_EQ(part.code, 0) << part.err;
    const Outcome info = run_grainfield({"info", "--json", folder_ / "cal.toml"});
    ASSERT_EQ(info.code, 0) << info.err;
    EXPECT_EQ(nlohmann::json::parse(part.out)["diameter_px"],
              nlohmann::json::parse(info.out)["diameter_px"]);
}

TEST_F(KeptCalibration, OfAnotherSizeOfFramesIsRefusedWithBoth) {
    const std::string text = testing::read_all(folder_ / "cal.toml");
    const auto at = text.find("width = ");
    const std::string line = text.substr(at, text.find('\n', at) - at);
    change(line, "width = 77");
    const Outcome outcome = track_changed();
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("77 x "));
    EXPECT_THAT(outcome.err, HasSubstr(line.substr(8) + " x "));
}

TEST_F(KeptCalibration, ThatIsDamagedIsRefusedWithFileAndKey) {
    struct Damage {
        const char *from, *to, *key;
    };
    for (const auto& [from, to, key] : {Damage{"core =", "core = \"x\" #", "light.core"},
                                        Damage{"polarity =", "colour =", "spheres.polarity"},
                                        Damage{"[check]", "[check]\nmood = 3 #", "check.mood"},
                                        Damage{"ground = [", "ground = [1, ", "light.background"},
                                        Damage{"calibration 1", "calibration 9", "format"}}) {
        change(from, to);
        const Outcome outcome = track_changed();
        EXPECT_EQ(outcome.code, 3) << key;
        EXPECT_THAT(outcome.err, HasSubstr("changed.toml': "));
        EXPECT_THAT(outcome.err, HasSubstr("key '" + std::string(key) + "'"));
    }
}

TEST_F(KeptCalibration, SaysThatSizeOrResidualAreOthers) {
    const std::string text = testing::read_all(folder_ / "cal.toml");
    const auto at = text.find("\ndiameter = ");
    change(text.substr(at, text.find('\n', at + 1) - at), "\ndiameter = 3");
    const Outcome outcome = track_changed();
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("not of the size that is kept"));
}

TEST_F(KeptCalibration, GoesWithNoOptionOfTheCalibration) {
    const Outcome outcome = track(frames_, {"-o", folder_ / "c.h5", "--calibration",
                                            folder_ / "cal.toml", "--disc-diameter", "9"});
    EXPECT_EQ(outcome.code, 2);
    EXPECT_THAT(outcome.err, HasSubstr("leaves nothing to estimate"));
}

}  // namespace
}  // namespace grainfield
