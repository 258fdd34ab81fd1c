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

TEST(Cards, SayHowLongAFilmIsOfWhichOneFrameInTenWasTaken) {
    Results run = film();
    run.frames = 31;
    EXPECT_THAT(make_cards({run}, std::nullopt)[2].values[0].detail, HasSubstr("; 0.062 s in all"));
    run.observables.back().measurements.push_back(
        {"film_length", "time unit", 0.62, std::nullopt, 0, ""});
    run.observables.back().measurements.push_back(
        {"frame_interval", "time unit", 0.02, std::nullopt, 0, ""});
    EXPECT_THAT(make_cards({run}, std::nullopt)[2].values[0].detail,
                HasSubstr("; one frame in 10 taken; 0.62 s in all"));
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

// A film without D, so that the card of long waves has its place.
Results without_diffusion() {
    Results run = film();
    std::erase_if(run.observables, [](const auto& o) { return o.name == "msd"; });
    return run;
}

ObservableResult& spectrum_of(Results& run) {
    return *std::ranges::find(run.observables, "sk", &ObservableResult::name);
}

const Card* card_called(const std::vector<Card>& cards, const std::string& title) {
    const auto card = std::ranges::find(cards, title, &Card::title);
    return card == cards.end() ? nullptr : &*card;
}

TEST(Cards, BetweenWallsShowTheModesThatFitThereAtTheirOwnK) {
    Results run = without_diffusion();
    ObservableResult& sk = spectrum_of(run);
    sk.measurements = {{"s_lowest_k", "-", 0.02, 0.001, 40, ""},
                       {"s_neumann_lowest_k", "-", 0.03, 0.001, 40, ""},
                       {"lowest_k", "1/a", 0.0314, std::nullopt, 0, ""}};
    for (Curve& curve : sk.curves) {
        if (curve.name == "sk_neumann") curve.columns[0].values.front() = 0.0157;
    }
    std::vector<Card> cards = make_cards({run}, std::nullopt);
    EXPECT_EQ(card_called(cards, "S(k→0)"), nullptr) << "there is no fit";
    const Card* card = card_called(cards, "S at the lowest k");
    ASSERT_NE(card, nullptr);
    EXPECT_EQ(card->values[0].value, "0.0300 ± 0.0010");
    EXPECT_THAT(card->values[0].detail, HasSubstr("k = 0.0157"));
    EXPECT_THAT(card->values[0].detail, HasSubstr("walls"));
    std::erase_if(sk.measurements, [](const auto& m) { return m.name == "s_neumann_lowest_k"; });
    cards = make_cards({run}, std::nullopt);
    card = card_called(cards, "S at the lowest k");
    ASSERT_NE(card, nullptr);
    EXPECT_EQ(card->values[0].value, "0.0200 ± 0.0010");
    EXPECT_THAT(card->values[0].detail, HasSubstr("k = 0.0314"));
}

TEST(Cards, ShowNoDiffusionOfAllSpheresInPlaceOfALiquidThatFlies) {
    Results run = film();
    ObservableResult& msd = *std::ranges::find(run.observables, "msd", &ObservableResult::name);
    msd.measurements = {{"d_all", "a^2/time unit", 2, 0.1, 9, ""},
                        {"d_liquid", "a^2/time unit", 3, 0.1, 9, ""},
                        {"exponent_liquid", "-", 1.3, 0.01, 9, ""}};
    EXPECT_EQ(card_called(make_cards({run}, std::nullopt), "Diffusion coefficient"), nullptr);
    run = with_possible_numbers(run);
    EXPECT_EQ(card_called(make_cards({run}, std::nullopt), "Diffusion coefficient"), nullptr);
    ObservableResult& rest = *std::ranges::find(run.observables, "msd", &ObservableResult::name);
    rest.measurements = {{"d_all", "a^2/time unit", 2, 0.1, 9, ""},
                         {"exponent_all", "-", 1.05, 0.01, 9, ""},
                         {"d_liquid", "a^2/time unit", std::nullopt, std::nullopt, 0, "no phases"}};
    const std::vector<Card> cards = make_cards({run}, std::nullopt);
    const Card* card = card_called(cards, "Diffusion coefficient");
    ASSERT_NE(card, nullptr);
    EXPECT_EQ(card->values[0].detail, "all spheres; MSD grows as t^1.05");
}

TEST(Cards, ShowTheLimitOfTheFitWhereThereIsOne) {
    Results run = without_diffusion();
    run.observables.push_back({"fit", {{"s0", "-", 0.011, 0.002, 9, ""}}, {}, {}, "", 0});
    const std::vector<Card> cards = make_cards({run}, std::nullopt);
    ASSERT_NE(card_called(cards, "S(k→0)"), nullptr);
    EXPECT_EQ(card_called(cards, "S(k→0)")->values[0].value, "0.0110 ± 0.0020");
    EXPECT_EQ(card_called(cards, "S at the lowest k"), nullptr);
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
    EXPECT_THAT(verdict(run, 0), testing::EndsWith("poor")) << "a poor fit hides places";
    run.observables.pop_back();
    EXPECT_EQ(verdict(run, 0), "10,274 spheres a frame") << "no camera, no residual";
}

TEST(Verdict, OfAFilmThatIsFittedToItsNoiseIsGood) {
    EXPECT_EQ(residual_words(0.13, 0.12), "residual 0.130, noise 0.120, good");
    EXPECT_EQ(residual_words(0.20, 0.12), "residual 0.200, noise 0.120, fair");
    EXPECT_EQ(residual_words(0.13, 0.01), "residual 0.130, noise 0.010, poor");
    EXPECT_EQ(residual_words(0.26, 0.26), "residual 0.260, noise 0.260, poor");
    EXPECT_EQ(residual_words(0.13, 0), "residual 0.130, poor") << "an old file";
    Results run = film();
    run.particles_mean = 10274;
    run.observables.back().measurements[1].value = 0.13;
    EXPECT_EQ(verdict(run, 0), "10,274 spheres a frame; residual 0.130, poor");
    run.observables.back().measurements.push_back({"noise", "-", 0.12, std::nullopt, 0, ""});
    EXPECT_EQ(verdict(run, 0),
              "10,274 spheres a frame; residual 0.130, noise 0.120, good; no place stands out");
}

TEST(Verdict, OfAFieldSaysItsParametersAndWhatItTendsTo) {
    Results run;
    run.identity = {.origin = Origin::field, .dimension = 2, .gradient_order = 4};
    run.identity.control =
        ControlValue{.parameter = ControlParameter::critical_distance, .value = 0.01, .unit = {}};
    EXPECT_EQ(verdict(run, std::nullopt), "Field, 2D, b = 4, ν = 0.01");
    run.observables = {{"field", {{"mean_density", "-", 0.5, 0.01, 9, ""}}, {}, {}, "", 0}};
    EXPECT_EQ(verdict(run, std::nullopt), "Field, 2D, b = 4, ν = 0.01; mean density 0.500 ± 0.010");
    run.observables.push_back({"fit", {{"s0", "-", 0.011, 0.002, 9, ""}}, {}, {}, "", 0});
    EXPECT_EQ(verdict(run, std::nullopt), "Field, 2D, b = 4, ν = 0.01; S₀ = 0.0110 ± 0.0020");
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
    run.observables[0].measurements[0].reason = "outside the runs, which are from 2 to 4";
    EXPECT_EQ(verdict(run, std::nullopt),
              "Critical at Γ = 4.50 ± 0.10; outside the runs, which are from 2 to 4");
    run.observables[0].measurements = {{"power", "-", 0.732, 0.005, 3, ""}};
    EXPECT_EQ(verdict(run, std::nullopt), "S₀/S₁ falls with Γ as a power of 0.7320 ± 0.0050");
    run.observables[0].measurements.push_back({"constant", "-", 0.07, 0.01, 3, ""});
    EXPECT_EQ(verdict(run, std::nullopt),
              "S₀/S₁ falls with Γ as a power of 0.7320 ± 0.0050, to 0.070 ± 0.010 at zero");
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
