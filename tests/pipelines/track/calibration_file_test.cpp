#include "pipelines/track/calibration_file.h"

#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"
#include "tests/support/program.h"
#include "tracking/model/known_models.h"
#include "tracking/synthesis/bias_terms.h"

namespace grainfield::pipelines {
namespace {

using ::testing::HasSubstr;
using tracking::KeptCalibration;

/// With a correction whose numbers have no short form.
KeptCalibration corrected() {
    KeptCalibration kept;
    kept.width = 120;
    kept.height = 80;
    kept.model.disc = {10, 1.5};
    kept.model.dark_level = 20;
    kept.model.background = tracking::BackgroundSurface(200);
    tracking::BiasCorrection& bias = kept.bias.emplace();
    bias.diameter = 16.1;
    bias.height = 1.94;
    bias.camera_distance = 40.5;
    bias.before = 0.0184;
    bias.after = 0.0101;
    RandomStream random(5, "bias");
    const auto fill = [&](std::vector<double>& numbers, int count) {
        for (int i = 0; i < count; ++i) numbers.push_back(0.01 * random.normal());
    };
    fill(bias.quality, tracking::kQualityClasses - 1);
    fill(bias.remaining, tracking::kQualityClasses * tracking::kOverlapClasses);
    fill(bias.weights, tracking::BiasTerms::kCount);
    return kept;
}

class CalibrationFile : public ::testing::Test {
 protected:
    KeptCalibration read(const std::string& text) {
        std::ofstream(path_) << text;
        return read_calibration(path_);
    }
    /// What is said of the file with `from` replaced; empty: it is read.
    std::string refusal(const std::string& from, const std::string& to) {
        std::string text = text_of(corrected());
        const auto at = text.find(from, text.find("[bias]"));
        EXPECT_NE(at, std::string::npos) << from;
        text.replace(at, from.size(), to);
        try {
            read(text);
        } catch (const InputError& error) {
            return error.what();
        }
        return "";
    }

    const testing::ScratchFolder folder_;
    const std::string path_ = folder_ / "cal.toml";
};

TEST_F(CalibrationFile, KeepsBlocksWithTheirBackgroundToTheBit) {
    KeptCalibration kept;
    kept.width = 121;
    kept.height = 80;
    kept.model.binning = {2};
    kept.model.disc = {7.1, 0.85};
    kept.model.dark_level = 20;
    kept.model.background = tracking::BackgroundSurface(60, 40, 1, {200, 3, -7});
    const KeptCalibration back = read(text_of(kept));
    EXPECT_EQ(back.model.binning, kept.model.binning);
    EXPECT_EQ(back.model.disc.diameter, kept.model.disc.diameter);
    EXPECT_EQ(back.model.background(13, 31), kept.model.background(13, 31));
}

TEST_F(CalibrationFile, GivesTheCorrectionOfTheBiasBackToTheBit) {
    const KeptCalibration kept = corrected();
    const KeptCalibration again = read(text_of(kept));
    ASSERT_TRUE(again.bias);
    EXPECT_EQ(*again.bias, *kept.bias);
    EXPECT_EQ(text_of(again), text_of(kept));
}

TEST_F(CalibrationFile, GivesTheOpticsOfSynthesisBackToTheBit) {
    KeptCalibration kept = corrected();
    kept.optics = tracking::FilmOptics{.diameter = 16.1,
                                       .height = 1.94,
                                       .optics = {.reflectivity = 0.6321987654321,
                                                  .blur = 0.0707123,
                                                  .ambient = 0.011,
                                                  .grazing = 0.2071,
                                                  .distance = 40.5},
                                       .error = {0.0123, 0.00071, 0.0091, 0.013},
                                       .error_scale = {{1.1, 1}, {2.61, 2.4}, 233}};
    const KeptCalibration again = read(text_of(kept));
    ASSERT_TRUE(again.optics);
    EXPECT_EQ(*again.optics, *kept.optics);
    EXPECT_EQ(text_of(again), text_of(kept));
    std::string damaged = text_of(kept);
    damaged.replace(damaged.find("factors-height = [2.61"), 22, "factors-height = [0.61");
    EXPECT_THROW(read(damaged), InputError);
}

TEST_F(CalibrationFile, WithoutACorrectionHasNone) {
    KeptCalibration kept = corrected();
    kept.bias.reset();
    EXPECT_THAT(text_of(kept), ::testing::Not(HasSubstr("[bias]")));
    EXPECT_FALSE(read(text_of(kept)).bias);
}

TEST_F(CalibrationFile, WithADamagedCorrectionIsRefusedWithFileAndKey) {
    struct Damage {
        const char *from, *to, *key;
    };
    for (const auto& [from, to, key] :
         {Damage{"diameter = 16.1", "diameter = 1", "bias.diameter"},
          Damage{"height = 1.94", "height = 0.4", "bias.height"},
          Damage{"camera-distance = ", "camera = ", "bias.camera-distance"},
          Damage{"before = ", "before = \"x\" #", "bias.before"},
          Damage{"after = ", "later = ", "bias.after"},
          Damage{"after = 0", "after = 7", "bias.after"},
          Damage{"quality = [", "quality = [1, ", "bias.quality"},
          Damage{"remaining = [", "remaining = [] #[", "bias.remaining"},
          Damage{"weights = [", "weights = [0.5, ", "bias.weights"},
          Damage{"[bias]", "[bias]\nmood = 3", "bias.mood"}}) {
        const std::string said = refusal(from, to);
        EXPECT_THAT(said, HasSubstr("cal.toml")) << key;
        EXPECT_THAT(said, HasSubstr(key));
    }
}

}  // namespace
}  // namespace grainfield::pipelines
