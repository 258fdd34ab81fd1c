#include "report/page/cards.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/page/definitions.h"
#include "report/possible_numbers.h"
#include "tests/report/sample_results.h"

namespace grainfield::report {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

std::vector<std::string> titles_of(const std::vector<Card>& cards) {
    std::vector<std::string> titles;
    for (const Card& card : cards) titles.push_back(card.title);
    return titles;
}

Results film() {
    Results run = sample::results({1, 120, 40, true, "A"});
    run.observables.push_back({"lengths",
                               {{"apparent_diameter", "px", 8.76, std::nullopt, 0, ""},
                                {"residual", "-", 0.0586, std::nullopt, 0, ""}},
                               {},
                               {},
                               "",
                               0});
    for (ObservableResult& observable : run.observables) {
        if (observable.name != "phase") continue;
        observable.measurements.push_back({"liquid_fraction", "-", 0.6, 0.004, 60, ""});
    }
    return run;
}

TEST(Cards, OfAFilmAreTheSixThatAreReadFirst) {
    const std::vector<Card> cards = make_cards({film()}, std::nullopt);
    EXPECT_THAT(titles_of(cards),
                ElementsAre("Spheres a frame", "Particle diameter a", "Frame rate", "Phases",
                            "Lattice spacing", "Diffusion coefficient"));
    EXPECT_EQ(cards[1].values[0].value, "10.09 px");
    EXPECT_EQ(cards[2].values[0].value, "500 frames/s");
    EXPECT_THAT(cards[2].values[0].detail, HasSubstr("as the film says"));
    EXPECT_EQ(cards[3].values[0].value, "solid 27.13 ± 0.31 %");
    EXPECT_EQ(cards[3].values[0].detail, "liquid 60.00 ± 0.40 %, rest 12.9 %");
    EXPECT_EQ(cards[5].values[0].value, "0.01253 ± 0.00021 a²/s");
}

TEST(Cards, SayWhereTheFrameRateComesFrom) {
    Results run = film();
    RunRecord track;
    track.command = "track";
    track.configuration = {{"fps", "500"}};
    run.sources = {track};
    EXPECT_THAT(make_cards({run}, std::nullopt)[2].values[0].detail, HasSubstr("given to track"));
    run.sources[0].configuration = {{"fps", "auto"}};
    EXPECT_THAT(make_cards({run}, std::nullopt)[2].values[0].detail, HasSubstr("as the film says"));
}

TEST(Cards, SayHowTheFilmWasVibrated) {
    Results run = film();
    run.source.origin = Origin::video;
    run.source.vibration_frequency.reset();
    run.identity.control.reset();
    EXPECT_THAT(make_cards({run}, std::nullopt)[2].values[0].detail, Not(HasSubstr("vibration")));
    run.source.vibration_frequency = 80;
    run.identity.control =
        ControlValue{.parameter = ControlParameter::acceleration, .value = 4.7, .unit = {}};
    EXPECT_THAT(make_cards({run}, std::nullopt)[2].values[0].detail,
                HasSubstr("; vibration 80 Hz, Γ = 4.7"));
    run.source.vibration_frequency.reset();
    EXPECT_THAT(make_cards({run}, std::nullopt)[2].values[0].detail,
                HasSubstr("; vibration Γ = 4.7"));
}

TEST(Cards, GiveLengthsInMillimetresWhereTheSphereIsKnown) {
    const std::vector<Card> cards = make_cards({film()}, 1.0);
    EXPECT_EQ(cards[1].values[0].value, "10.09 px = 1 mm");
    EXPECT_THAT(cards[1].values[0].detail, HasSubstr("1 px is 0.0991 mm"));
}

TEST(Cards, CallADiameterApparentThatStandsForTheTrueOne) {
    Results run = film();
    run.source.diameter_origin = DiameterOrigin::apparent;
    EXPECT_TRUE(make_cards({run}, std::nullopt)[1].values[0].detail.starts_with("apparent: "));
    run.source.diameter_origin = DiameterOrigin::given;
    EXPECT_TRUE(make_cards({run}, std::nullopt)[1].values[0].detail.starts_with("given"));
    EXPECT_THAT(definition_of("Particle diameter a"),
                HasSubstr("true one if given, else the apparent one"));
}

TEST(Cards, OfOneFrameShowOtherNumbersInPlaceOfThoseThatItCannotHave) {
    Results run = with_possible_numbers(film());
    run.frames = 1;
    run = with_possible_numbers(run);
    const auto titles = titles_of(make_cards({run}, std::nullopt));
    EXPECT_THAT(titles, Not(testing::Contains("Phases")));
    EXPECT_THAT(titles, Not(testing::Contains("Frame rate")));
    EXPECT_THAT(titles, testing::Contains("residual"));
}

TEST(Cards, OfSeveralRunsNameEach) {
    const std::string html = cards_html(make_cards({film(), film()}, std::nullopt), {"A", "<B>"});
    EXPECT_THAT(html, HasSubstr("&lt;B&gt;"));
    EXPECT_THAT(html, Not(HasSubstr("<B>")));
}

TEST(Verdict, JudgesTheResidualAndCountsPlaces) {
    Results run = film();
    run.particles_mean = 10274.2;
    EXPECT_EQ(verdict(run, 3), "10,274 spheres a frame; residual 0.059, good; 3 places to look at");
    EXPECT_EQ(verdict(run, 0), "10,274 spheres a frame; residual 0.059, good; no place stands out");
    EXPECT_EQ(verdict(run, std::nullopt), "10,274 spheres a frame; residual 0.059, good");
    run.observables.back().measurements[1].value = 0.1;
    EXPECT_THAT(verdict(run, 1), HasSubstr("0.100, fair; 1 place to look at"));
    run.observables.back().measurements[1].value = 0.2;
    EXPECT_THAT(verdict(run, 1), HasSubstr("poor"));
    run.previews.resize(1);
    run.previews[0].snapshot.quality = {0.05, 0.06, 0.05};
    EXPECT_THAT(verdict(run, 0), HasSubstr("poor; 0.054 about the spheres: --region or --mask "
                                           "leaves the rest out"));
    run.previews[0].snapshot.quality = {0.19, 0.2, 0.21};
    EXPECT_THAT(verdict(run, 0), HasSubstr("poor; no place stands out"));
    run.observables.pop_back();
    EXPECT_EQ(verdict(run, 0), "10,274 spheres a frame") << "no camera, no residual";
}

TEST(Verdict, OfACriticalPointIsItsValueOrWhyThereIsNone) {
    Results run;
    run.identity.role = RunRole::critical_point;
    EXPECT_EQ(verdict(run, std::nullopt), "No critical point");
    ObservableResult critical;
    critical.name = "critical";
    critical.curves = {{"critical", "", {{"x", "-", "Γ", {1}}}, {}}};
    critical.measurements = {
        {"critical_value", "-", std::nullopt, std::nullopt, 0, "two points only"}};
    run.observables = {critical};
    EXPECT_EQ(verdict(run, std::nullopt), "No critical Γ: two points only");
    run.observables[0].measurements[0] = {"critical_value", "-", 4.5, 0.1, 3, ""};
    EXPECT_EQ(verdict(run, std::nullopt), "Critical at Γ = 4.50 ± 0.10");
}

TEST(FirstFile, IsThatOfTheOldestStep) {
    Results run = film();
    EXPECT_EQ(first_file(run), "layer_4.50.h5");
    RunRecord track;
    track.inputs = {{"/films/frame_0.tif", 1, ""}, {"/films/frame_1.tif", 1, ""}};
    run.sources = {track};
    EXPECT_EQ(first_file(run), "frame_0.tif and 1 more");
}

}  // namespace
}  // namespace grainfield::report
