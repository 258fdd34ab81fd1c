// `grainfield tune`: a page to choose the settings of `track` by.
#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "tests/support/disc_sequence.h"
#include "tests/support/program.h"

namespace grainfield {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::Outcome;
using testing::run_grainfield;
using testing::ScratchFolder;

TEST(Tune, ShowsWhatTrackFindsAndSuggestsSettingsThatTrackTakes) {
    const ScratchFolder folder;
    const auto frames = testing::write_disc_sequence(folder, 4);
    std::vector<std::string> words{"tune", "-o", folder / "t.html", "--json", "--no-figures"};
    words.insert(words.end(), frames.begin(), frames.end());
    const Outcome outcome = run_grainfield(words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const json tuned = json::parse(outcome.out);
    EXPECT_EQ(tuned["frames"], 3);
    EXPECT_NEAR(tuned["diameter_px"].get<double>(), testing::kApparentDiameter, 0.1);
    EXPECT_EQ(tuned["settings"]["calibrate.polarity"], "\"dark\"");

    const std::string page = testing::read_all(folder / "t.html");
    for (const char* part :
         {"Suggested settings", "Bias to the pixel grid", "figure-subpixel_phase",
          "figure-nearest_neighbour", "figure-evidence", "figure-residual", "figure-radial_profile",
          "residual: image − model"}) {
        EXPECT_THAT(page, HasSubstr(part));
    }
    const std::size_t data = page.find("\"alternatives\":{");
    ASSERT_NE(data, std::string::npos);
    // The last member of the object that the page holds.
    const std::size_t end = page.find("}\n</script>", data);
    ASSERT_NE(end, std::string::npos);
    const json tried = json::parse(page.substr(data + 15, end - data - 15), nullptr, false);
    ASSERT_TRUE(tried.is_object());
    EXPECT_EQ(tried["tried"].size(), 2U * 7 * 4) << "polarities, diameters, thresholds";
    const auto spheres = [&](std::size_t polarity, std::size_t diameter, std::size_t threshold) {
        return tried["tried"][(7 * polarity + diameter) * 4 + threshold]["at"].size() / 2;
    };
    EXPECT_GT(spheres(0, 3, 1), 50U) << "the settings in use";
    EXPECT_LE(spheres(0, 3, 3), spheres(0, 3, 0)) << "a higher threshold keeps fewer";
    EXPECT_THAT(page, Not(HasSubstr("Structure factor"))) << "nothing that was not measured";
    EXPECT_LT(page.find("id=\"map\""), page.find("Suggested settings")) << "the picture first";
    EXPECT_LT(page.find("Suggested settings"), page.find("Bias to the pixel grid"));
    const std::size_t block = page.find("<pre", page.find("Suggested settings"));
    EXPECT_THAT(page.substr(block, 400), HasSubstr("polarity = &quot;dark&quot;"));
    EXPECT_THAT(page, HasSubstr("px; residual 0.0"));

    // The same spheres, without any calibration of polarity, D and w.
    std::vector<std::string> plain{"track", "--json", "-o", folder / "a.h5"};
    std::vector<std::string> with{"track",         "--json", "-o",
                                  folder / "b.h5", "-c",     folder / "t.toml"};
    plain.insert(plain.end(), frames.begin(), frames.end());
    with.insert(with.end(), frames.begin(), frames.end());
    const Outcome a = run_grainfield(plain);
    const Outcome b = run_grainfield(with);
    ASSERT_EQ(a.code, 0) << a.err;
    ASSERT_EQ(b.code, 0) << b.err;
    const json found = json::parse(a.out);
    const json again = json::parse(b.out);
    EXPECT_EQ(again["particles_mean"], found["particles_mean"]);
    EXPECT_EQ(tuned["particles_mean"], found["particles_mean"]);
    EXPECT_NEAR(again["residual_rms"].get<double>(), found["residual_rms"].get<double>(), 1e-4);
    EXPECT_NEAR(again["diameter_px"].get<double>(), tuned["diameter_px"].get<double>(), 1e-3);
}

TEST(Tune, AnswersAGivenSizeThatExplainsLittleWithTheOneThatIsThere) {
    const ScratchFolder folder;
    testing::write_png(folder / "discs.png", testing::disc_frame(testing::few_discs(), 0));
    const Outcome outcome = run_grainfield({"tune", folder / "discs.png", "-o", folder / "t.html",
                                            "--no-figures", "--diameter", "20"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("t.toml (those that fit better, see the warning)"));
    EXPECT_THAT(outcome.err, HasSubstr("discs of 20.0 px explain"));
    EXPECT_THAT(outcome.err, HasSubstr("dark discs of about 9."));
    EXPECT_THAT(outcome.err, HasSubstr("give --polarity dark and leave --disc-diameter out"));
    EXPECT_THAT(outcome.out, HasSubstr("--polarity 'dark'"));
    EXPECT_THAT(testing::read_all(folder / "t.toml"),
                AllOf(HasSubstr("polarity = \"dark\""), Not(HasSubstr("disc-diameter")),
                      Not(HasSubstr("edge-width"))));
    const std::string page = testing::read_all(folder / "t.html");
    EXPECT_THAT(page, HasSubstr("Another size fits better"));
    EXPECT_THAT(page, HasSubstr("dark D = 9.")) << "a picture of it stands beside";
    // The slider for the diameter is about the size that is there, not the one that was given.
    EXPECT_THAT(page, ContainsRegex("\"9\\.[0-9][0-9] px\""));
    EXPECT_THAT(page, Not(HasSubstr("\"20.00 px\"")));
}

TEST(Tune, SeesPairsThatTheCellHasNoRoomFor) {
    const ScratchFolder folder;
    testing::LayerScene scene = testing::few_discs();
    scene.position.push_back(scene.position[40] + Vec2{4.5, 0});
    testing::write_png(folder / "pair.png", testing::disc_frame(scene, 0));
    const Outcome outcome =
        run_grainfield({"tune", folder / "pair.png", "-o", folder / "t.html", "--no-figures",
                        "--height", "1.6", "--sphere-diameter", "10"});
    ASSERT_EQ(outcome.code, 0) << outcome.err;
    const std::string page = testing::read_all(folder / "t.html");
    const std::size_t row = page.find("Spheres without room between the plates");
    ASSERT_NE(row, std::string::npos);
    EXPECT_THAT(page.substr(row, 120), HasSubstr(">2<"));
    EXPECT_THAT(testing::read_all(folder / "t.toml"), HasSubstr("[layers]\nheight = 1.6\n"));
}

TEST(Tune, SaysWhenThereIsNothingToTuneOn) {
    const ScratchFolder folder;
    testing::write_png(folder / "grey.png", Image(128, 128, 90));
    const Outcome outcome =
        run_grainfield({"tune", folder / "grey.png", "-o", folder / "t.html", "--no-figures"});
    EXPECT_EQ(outcome.code, 3);
    EXPECT_THAT(outcome.err, HasSubstr("nothing to tune on"));
    EXPECT_EQ(folder.entries(), 1U);
}

}  // namespace
}  // namespace grainfield
