#include "pipelines/tune/tune_settings.h"

#include <algorithm>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::pipelines {
namespace {

using ::testing::HasSubstr;

class TuneSettings : public ::testing::Test {
 protected:
    TuneSettings() {
        model_.disc.diameter = 21.5;
        model_.disc.edge_width = 1.25;
    }
    std::vector<Setting> suggested() const {
        return suggested_settings({model_, options_, surveys_}, film_);
    }
    static std::optional<std::string> value(const std::vector<Setting>& settings,
                                            const std::string& section, const std::string& name) {
        std::optional<std::string> found;
        for (const Setting& s : settings) {
            if (s.section != section || s.name != name) continue;
            EXPECT_FALSE(found) << name << " is there twice";
            found = s.value;
        }
        return found;
    }

    tracking::ImageModel model_;
    tracking::TrackOptions options_;
    std::vector<tracking::Survey> surveys_;
    FilmOptions film_;
};

TEST_F(TuneSettings, KeepAllThatTheUserGave) {
    film_.background = "running";
    film_.background_frames = 31;
    film_.background_window = 400;
    film_.strict = true;
    film_.fps = 12.5;
    film_.mask = "a \"b\" c.png";
    options_.sphere_diameter = 24.25;
    options_.link.memory = 5;
    const std::vector<Setting> settings = suggested();
    EXPECT_EQ(value(settings, "track", "background"), "\"running\"");
    EXPECT_EQ(value(settings, "track", "background-frames"), "31");
    EXPECT_EQ(value(settings, "track", "background-window"), "400");
    EXPECT_EQ(value(settings, "track", "strict"), "true");
    EXPECT_EQ(value(settings, "track", "fps"), "12.5");
    EXPECT_EQ(value(settings, "track", "mask"), "\"a \\\"b\\\" c.png\"");
    EXPECT_EQ(value(settings, "track", "sphere-diameter"), "24.25");
    EXPECT_EQ(value(settings, "link", "memory"), "5");
}

TEST_F(TuneSettings, LeaveOutWhatIsAsByDefault) {
    const std::vector<Setting> settings = suggested();
    EXPECT_EQ(value(settings, "track", "background"), std::nullopt);
    EXPECT_EQ(value(settings, "track", "max-pixels"), std::nullopt);
    EXPECT_TRUE(std::ranges::all_of(settings, [](const Setting& s) {
        return s.section == "calibrate" || s.section == "refine";
    }));
}

TEST_F(TuneSettings, PutWhatWasEstimatedInPlaceOfWhatWasGiven) {
    options_.calibration.diameter = 20;
    const std::vector<Setting> settings = suggested();
    EXPECT_EQ(value(settings, "calibrate", "disc-diameter"), "21.500");
    EXPECT_EQ(value(settings, "calibrate", "edge-width"), "1.250");
}

TEST_F(TuneSettings, OfACandidateKeepAllElseThatTheUserGave) {
    film_.region = {0, 0, 10, 10};
    film_.mask = "m.png";
    options_.layers.height = 1.94;
    options_.calibration.diameter = 20;
    options_.calibration.edge_width = 3;
    tracking::SizeCandidate candidate;
    candidate.polarity = tracking::Polarity::bright;
    candidate.diameter = 8.5;
    const std::vector<Setting> settings = settings_of(options_, film_, candidate);
    EXPECT_EQ(value(settings, "track", "region"), "\"0,0,10,10\"");
    EXPECT_EQ(value(settings, "track", "mask"), "\"m.png\"");
    EXPECT_EQ(value(settings, "calibrate", "disc-diameter"), "8.50");
    EXPECT_EQ(value(settings, "calibrate", "polarity"), "\"bright\"");
    EXPECT_EQ(value(settings, "calibrate", "edge-width"), std::nullopt) << "of another size";
    EXPECT_TRUE(std::ranges::any_of(
        settings, [](const Setting& s) { return s.name == "height" && s.value == "1.94"; }));
}

TEST_F(TuneSettings, AreAConfigurationFileWithOneBlockASection) {
    film_.region = {0, 0, 10, 10};
    const std::string toml = toml_of(suggested());
    EXPECT_THAT(toml, HasSubstr("\n[track]\nregion = \"0,0,10,10\"\n"));
    EXPECT_THAT(toml, HasSubstr("\n[calibrate]\n"));
    EXPECT_EQ(toml.find("[calibrate]"), toml.rfind("[calibrate]"));
}

}  // namespace
}  // namespace grainfield::pipelines
