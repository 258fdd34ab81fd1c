#include "tracking/calibrate/size_choice.h"

#include <gtest/gtest.h>

namespace grainfield::tracking {
namespace {

SizeCandidate candidate(Polarity polarity, double diameter, double signal, double charged) {
    SizeCandidate c;
    c.polarity = polarity;
    c.diameter = diameter;
    c.explained = {.all = signal, .signal = signal, .support = 5, .charged = charged};
    return c;
}

TEST(SizeChoice, ManySoftDiscsDoNotBeatFewSharpOnesThatExplainLess) {
    const SizeChoice choice = choose_size({candidate(Polarity::bright, 6.2, 0.956, 0),
                                           candidate(Polarity::dark, 28.1, 0.897, 0.895)});
    EXPECT_EQ(choice.best, 1U);
    EXPECT_FALSE(choice.rival);
    EXPECT_TRUE(choice.explains_enough);
}

TEST(SizeChoice, TwoAnswersThatLeaveAboutAsMuchAreRivals) {
    const SizeChoice choice = choose_size(
        {candidate(Polarity::dark, 12, 0.90, 0.88), candidate(Polarity::bright, 12, 0.91, 0.89)});
    EXPECT_EQ(choice.best, 1U);
    EXPECT_EQ(choice.rival, 0U);
}

TEST(SizeChoice, TheSameSizeFoundTwiceIsNoRival) {
    const SizeChoice choice = choose_size(
        {candidate(Polarity::dark, 12, 0.90, 0.88), candidate(Polarity::dark, 12.4, 0.91, 0.89)});
    EXPECT_FALSE(choice.rival);
}

TEST(SizeChoice, WhatExplainsTooLittleIsNeitherEnoughNorARival) {
    EXPECT_FALSE(choose_size({candidate(Polarity::dark, 12, 0.79, 0.7)}).explains_enough);
    EXPECT_FALSE(choose_size({candidate(Polarity::dark, 12, 0.81, 0.7),
                              candidate(Polarity::bright, 12, 0.79, 0.69)})
                     .rival);
    EXPECT_FALSE(choose_size({}).best);
}

TEST(SizeChoice, OneThatExplainsEnoughIsBetterThanAGivenOneThatDoesNot) {
    const SizeCandidate given = candidate(Polarity::dark, 20, 0.3, 0.28);
    const SizeCandidate found = candidate(Polarity::dark, 8.93, 0.97, 0.96);
    const auto better =
        better_than(given, {given, candidate(Polarity::bright, 5, 0.85, 0.6), found});
    ASSERT_TRUE(better);
    EXPECT_EQ(better->diameter, 8.93);
    EXPECT_EQ(advice_on_size(given, *better),
              "with what is given, dark discs of 20.0 px explain 30 % of the frame; dark discs of "
              "about 8.9 px explain 97 %: leave calibrate.disc-diameter out");
    EXPECT_EQ(advice_on_size(candidate(Polarity::bright, 9, 0.3, 0.2), *better),
              "with what is given, bright discs of 9.0 px explain 30 % of the frame; dark discs of "
              "about 8.9 px explain 97 %: give calibrate.polarity dark");
    EXPECT_EQ(
        advice_on_size(candidate(Polarity::bright, 20, 0.3, 0.2), *better),
        "with what is given, bright discs of 20.0 px explain 30 % of the frame; dark discs of "
        "about 8.9 px explain 97 %: give calibrate.polarity dark and leave "
        "calibrate.disc-diameter out");
}

TEST(SizeChoice, NothingIsBetterThanAGivenOneThatExplainsEnoughOrWhereNothingDoes) {
    const SizeCandidate good = candidate(Polarity::dark, 20, 0.81, 0.8);
    const SizeCandidate bad = candidate(Polarity::dark, 20, 0.3, 0.28);
    EXPECT_FALSE(better_than(good, {good, candidate(Polarity::dark, 9, 0.97, 0.96)}));
    EXPECT_FALSE(better_than(bad, {bad, candidate(Polarity::dark, 9, 0.7, 0.69)}));
    EXPECT_FALSE(better_than(bad, {bad, candidate(Polarity::dark, 20.5, 0.9, 0.89)}))
        << "the same size";
}

TEST(SizeChoice, WordsNameThreeAtMostTheBestOnesFirst) {
    const std::string words =
        in_words({candidate(Polarity::bright, 1, 0.1, 0.1), candidate(Polarity::dark, 2, 0.4, 0.4),
                  candidate(Polarity::dark, 3, 0.3, 0.3), candidate(Polarity::dark, 4, 0.2, 0.2)});
    EXPECT_EQ(words.rfind("dark D = 2.0 px explains 40.0 %", 0), 0U) << words;
    EXPECT_EQ(words.find("bright"), std::string::npos);
}

}  // namespace
}  // namespace grainfield::tracking
