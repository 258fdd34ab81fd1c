#include "core/option_table.h"

#include <cmath>
#include <limits>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include "core/errors.h"

namespace grainfield {
namespace {

using testing::HasSubstr;

enum class Polarity { dark, bright };

struct Options {
    bool fast = false;
    int memory = 3;
    std::int64_t steps = 10;
    double range = 0.5;
    std::optional<double> diameter;
    std::string title = "run";
    Polarity polarity = Polarity::dark;
};

OptionTable describe(Options& o) {
    OptionTable t("link");
    t.flag("fast", o.fast, "skip checks");
    t.integer("memory", o.memory, "frames", {0, 100}, "how long a lost particle is remembered");
    t.integer("steps", o.steps, "-", {1, 1e18}, "steps");
    t.number("search-range", o.range, "a", {0, 10}, "largest step");
    t.number("diameter", o.diameter, "px", {3, 400}, "apparent diameter");
    t.text("title", o.title, "title");
    t.choice("polarity", o.polarity, {{"dark", Polarity::dark}, {"bright", Polarity::bright}},
             "spheres against background");
    return t;
}

std::string refusal(const std::function<void()>& action) {
    try {
        action();
    } catch (const OptionError& error) {
        return error.what();
    }
    return "nothing was thrown";
}

TEST(OptionTable, AnOptionIsSetByItsOtherNamesToo) {
    double disc = 9;
    OptionTable table("calibrate");
    table.number("disc-diameter", disc, "px", {3, 400}, "apparent diameter");
    table.also_called("diameter");
    table.set("diameter", 12.0);
    EXPECT_EQ(disc, 12);
    EXPECT_EQ(table.find("diameter"), table.find("disc-diameter"));
    EXPECT_EQ(table.find("disc"), nullptr);
    EXPECT_EQ(table.rows().size(), 1U);
}

TEST(OptionTable, SetsEveryKindOfFieldFromValuesAndFromText) {
    Options o;
    const OptionTable t = describe(o);
    t.set("fast", true);
    t.set("memory", std::int64_t{7});
    t.set("search-range", std::int64_t{2});
    t.set("diameter", 8.9);
    t.set("polarity", std::string("bright"));
    EXPECT_TRUE(o.fast);
    EXPECT_EQ(o.memory, 7);
    EXPECT_EQ(o.range, 2);
    EXPECT_EQ(o.diameter, 8.9);
    EXPECT_EQ(o.polarity, Polarity::bright);
    t.find("diameter")->set_from_text("auto");
    t.find("steps")->set_from_text("9007199254740993");
    t.find("fast")->set_from_text("off");
    t.find("title")->set_from_text("auto");
    EXPECT_EQ(o.diameter, std::nullopt);
    EXPECT_EQ(o.steps, 9007199254740993);
    EXPECT_FALSE(o.fast);
    EXPECT_EQ(o.title, "auto");
}

TEST(OptionTable, AFlagMayBeAutoWhereItIsDeclared) {
    std::optional<bool> wanted;
    OptionTable t("track");
    t.flag("correct", wanted, "correct positions");
    const Option& row = *t.find("correct");
    EXPECT_THAT(row.domain_text(), HasSubstr("default auto"));
    row.set_from_text("true");
    EXPECT_EQ(wanted, true);
    row.set_from_text("no");
    EXPECT_EQ(wanted, false);
    row.set_from_text("auto");
    EXPECT_EQ(wanted, std::nullopt);
    t.set("correct", true);
    EXPECT_EQ(to_text(row.get()), "true");
    EXPECT_THAT(refusal([&] { row.set_from_text("perhaps"); }), HasSubstr("true or false or auto"));
    EXPECT_EQ(wanted, true) << "what is refused changes nothing";
    bool plain = false;
    t.flag("plain", plain, "no auto");
    EXPECT_THROW(t.find("plain")->set_from_text("auto"), OptionError);
}

TEST(OptionTable, AWholeNumberMayBeLeftToTheProgram) {
    std::optional<int> binning;
    OptionTable t("track");
    t.integer("binning", binning, "px", {1, 32}, "side of the blocks");
    const Option& row = *t.find("binning");
    EXPECT_EQ(to_text(row.default_value), "auto");
    row.set_from_text("2");
    EXPECT_EQ(binning, 2);
    EXPECT_EQ(row.get(), OptionValue(std::int64_t{2}));
    t.set("binning", std::int64_t{3});
    EXPECT_EQ(binning, 3);
    for (const char* other : {"0", "33", "2.5", "automatic"}) {
        EXPECT_THROW(row.set_from_text(other), OptionError) << other;
    }
    EXPECT_EQ(binning, 3) << "what is refused changes nothing";
    row.set_from_text("auto");
    EXPECT_EQ(binning, std::nullopt);
    EXPECT_EQ(to_text(row.get()), "auto");
}

TEST(OptionTable, ANumberMayBeFollowedByItsUnit) {
    std::optional<double> diameter;
    std::vector<double> lengths;
    double share = 0;
    OptionTable t("track");
    t.number("sphere-diameter", diameter, "px", {2, 2000}, "true diameter");
    t.numbers("spacing", lengths, "a", {0, 10}, "lengths");
    t.number("share", share, "-", {0, 1}, "of the area");
    const Option& row = *t.find("sphere-diameter");
    row.set_from_text("10.09px");
    EXPECT_EQ(diameter, 10.09);
    row.set_from_text("11 px");
    EXPECT_EQ(diameter, 11);
    t.find("spacing")->set_from_text("0.8a,1");
    EXPECT_EQ(lengths, (std::vector<double>{0.8, 1}));
    for (const char* other : {"1mm", "px", "10px px", "10p"}) {
        EXPECT_THROW(row.set_from_text(other), OptionError) << other;
    }
    EXPECT_THROW(t.find("share")->set_from_text("0.5-"), OptionError) << "a number has no unit";
    EXPECT_EQ(diameter, 11) << "what is refused changes nothing";
}

TEST(OptionTable, RefusesWrongKindsRangesAndNanAndLeavesTheFieldAsItWas) {
    Options o;
    const OptionTable t = describe(o);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(t.set("memory", 3.5), OptionError);
    EXPECT_THROW(t.set("memory", std::int64_t{101}), OptionError);
    EXPECT_THROW(t.set("search-range", nan), OptionError);
    EXPECT_THROW(t.set("search-range", std::numeric_limits<double>::infinity()), OptionError);
    EXPECT_THROW(t.set("search-range", -0.001), OptionError);
    EXPECT_THROW(t.set("search-range", std::string("auto")), OptionError);
    EXPECT_THROW(t.set("diameter", true), OptionError);
    EXPECT_THROW(t.set("title", std::int64_t{3}), OptionError);
    EXPECT_THROW(t.set("fast", std::int64_t{1}), OptionError);
    EXPECT_THROW(t.set("polarity", std::string("grey")), OptionError);
    for (const char* text : {"", "1e", "0x3", "nan", "inf", "3 px", " 3"}) {
        EXPECT_THROW(t.find("search-range")->set_from_text(text), OptionError) << text;
        EXPECT_THROW(t.find("memory")->set_from_text(text), OptionError) << text;
    }
    EXPECT_EQ(o.memory, 3);
    EXPECT_EQ(o.range, 0.5);
    EXPECT_EQ(o.diameter, std::nullopt);
    EXPECT_EQ(o.title, "run");
    EXPECT_FALSE(o.fast);
    EXPECT_EQ(o.polarity, Polarity::dark);
}

TEST(OptionTable, MessagesNameOptionValueExpectationAndTheNearestName) {
    Options o;
    const OptionTable t = describe(o);
    EXPECT_EQ(refusal([&] { t.set("diameter", 2.0); }),
              "option 'diameter' has a wrong value: '2'; expected a number 3 … 400 [px] or auto.");
    EXPECT_THAT(refusal([&] { t.set("polarity", std::string("brigth")); }),
                HasSubstr("did you mean 'bright'?"));
    EXPECT_THAT(refusal([&] { t.set("serach-range", 1.0); }),
                HasSubstr("did you mean 'search-range'?"));
    EXPECT_THAT(refusal([&] { t.set("zzz", 1.0); }), testing::Not(HasSubstr("did you mean")));
}

struct Lists {
    std::vector<std::int64_t> lags;
    std::vector<int> waves{1, 2};
    std::vector<double> edges;
    std::optional<std::vector<double>> sides;
    std::vector<std::string> observables{"all"};
    std::vector<double> box;
};

OptionTable describe(Lists& o) {
    constexpr double infinite = std::numeric_limits<double>::infinity();
    OptionTable t("lists");
    t.integers("lags", o.lags, "frames", {.minimum = 1}, "lags to look at");
    t.integers("waves", o.waves, "", {1, 9}, "multiples");
    t.numbers("edges", o.edges, "1/a", {.minimum = 0}, "edges", {.minimum = 2});
    t.numbers("sides", o.sides, "a", {1e-9, infinite, true}, "sides");
    t.names("observables", o.observables, {"all", "q4", "sk"}, "what to measure");
    t.numbers("box", o.box, "a", {1e-9, 1e9}, "sides of the box", {2, 2});
    return t;
}

TEST(OptionTable, AListIsSetFromTextAndReadsBackAsText) {
    Lists o;
    const OptionTable t = describe(o);
    t.find("lags")->set_from_text(" 1, 10,100 ");
    EXPECT_EQ(o.lags, (std::vector<std::int64_t>{1, 10, 100}));
    EXPECT_EQ(to_text(t.find("lags")->get()), "1,10,100");
    t.set("lags", std::int64_t{7});
    EXPECT_EQ(o.lags, std::vector<std::int64_t>{7});
    t.set("lags", std::string());
    EXPECT_TRUE(o.lags.empty());
    t.set("edges", std::string("0.05,1e-1,+2"));
    EXPECT_EQ(o.edges, (std::vector<double>{0.05, 0.1, 2}));
    EXPECT_EQ(to_text(t.find("edges")->get()), "0.05,0.1,2");
    t.set("observables", std::string("q4,sk"));
    EXPECT_EQ(o.observables, (std::vector<std::string>{"q4", "sk"}));
}

TEST(OptionTable, AListMayBeAutoAndHoldInfOnlyWhereItIsDeclared) {
    Lists o;
    const OptionTable t = describe(o);
    EXPECT_EQ(to_text(t.find("sides")->get()), "auto");
    t.find("sides")->set_from_text("80,inf");
    ASSERT_TRUE(o.sides);
    EXPECT_EQ(*o.sides, (std::vector<double>{80, std::numeric_limits<double>::infinity()}));
    EXPECT_EQ(to_text(t.find("sides")->get()), "80,inf");
    t.find("sides")->set_from_text("auto");
    EXPECT_FALSE(o.sides);
    EXPECT_THROW(t.set("box", std::string("1,inf")), OptionError);
    EXPECT_THROW(t.set("box", std::string("auto")), OptionError);
}

TEST(OptionTable, AWrongElementOrCountIsRefusedAndTheListStaysAsItWas) {
    Lists o;
    const OptionTable t = describe(o);
    for (const char* text : {"0", "1,,2", ",1", "1 2", "1.5", "x", "99999999999999999999"}) {
        EXPECT_THROW(t.set("lags", std::string(text)), OptionError) << text;
    }
    for (const char* text : {"", "0", "10", "1,2,3000000000"}) {
        EXPECT_THROW(t.set("waves", std::string(text)), OptionError) << text;
    }
    EXPECT_THROW(t.set("edges", std::string("1")), OptionError);
    for (const char* text : {"1", "1,2,3", "0,1", "nan,1"}) {
        EXPECT_THROW(t.set("box", std::string(text)), OptionError) << text;
    }
    EXPECT_THROW(t.set("observables", std::string()), OptionError);
    EXPECT_THROW(t.set("waves", true), OptionError);
    EXPECT_TRUE(o.lags.empty());
    EXPECT_EQ(o.waves, (std::vector<int>{1, 2}));
    EXPECT_TRUE(o.box.empty());
}

TEST(OptionTable, MessagesOfAListNameTheElementAndHowManyAreExpected) {
    Lists o;
    const OptionTable t = describe(o);
    EXPECT_EQ(refusal([&] { t.set("lags", std::string("1,x")); }),
              "option 'lags' has a wrong value: 'x' in '1,x'; expected integers ≥ 1 [frames], with "
              "commas between them.");
    EXPECT_EQ(refusal([&] { t.set("box", 3.5); }),
              "option 'box' has a wrong value: '3.5'; expected 2 numbers 1e-09 … 1e+09 [a], with "
              "commas between them.");
    EXPECT_THAT(refusal([&] { t.set("observables", std::string("sk,q5")); }),
                testing::AllOf(HasSubstr("'q5' in 'sk,q5'"), HasSubstr("some of all, q4, sk"),
                               HasSubstr("did you mean 'q4'?")));
    EXPECT_EQ(t.find("sides")->domain_text(), "[a] ≥ 1e-09, default auto");
    EXPECT_EQ(t.find("observables")->domain_text(), "some of all, q4, sk; default all");
}

TEST(OptionTable, DescribesUnitRangeAndTheDefaultAtTheTimeOfBinding) {
    Options o;
    const OptionTable t = describe(o);
    t.set("search-range", 4.0);
    EXPECT_EQ(t.find("search-range")->domain_text(), "[a] 0 … 10, default 0.5");
    EXPECT_EQ(t.find("diameter")->domain_text(), "[px] 3 … 400, default auto");
    EXPECT_EQ(t.find("polarity")->domain_text(), "one of dark, bright; default dark");
    EXPECT_EQ(t.find("fast")->domain_text(), "");
    EXPECT_EQ(t.find("title")->domain_text(), "default run");
}

TEST(OptionTable, TextOfAValueReadsBackAsTheSameValue) {
    EXPECT_TRUE(rc::check([](double number, std::int64_t whole) {
        Options o;
        OptionTable t("free");
        t.number("x", o.range, "-", {}, "any number");
        t.integer("n", o.steps, "-", {}, "any integer");
        RC_PRE(std::isfinite(number));
        t.find("x")->set_from_text(to_text(number));
        t.find("n")->set_from_text(to_text(whole));
        RC_ASSERT(o.range == number);
        RC_ASSERT(o.steps == whole);
    }));
}

TEST(OptionTable, ArbitraryTextNeverPutsANumberOutOfRange) {
    EXPECT_TRUE(rc::check([] {
        const auto text = *rc::gen::container<std::string>(
            rc::gen::elementOf(std::string("0123456789.eE+-naifx ")));
        Options o;
        const OptionTable t = describe(o);
        for (const Option& option : t.rows()) {
            try {
                option.set_from_text(text);
            } catch (const OptionError&) {
            }
        }
        RC_ASSERT(o.range >= 0 && o.range <= 10);
        RC_ASSERT(o.memory >= 0 && o.memory <= 100);
        RC_ASSERT(!o.diameter || (*o.diameter >= 3 && *o.diameter <= 400));
    }));
}

TEST(NearestName, FindsTyposAndPrefixesButNotStrangers) {
    const std::vector<std::string> names{"diameter", "search-range", "threads"};
    EXPECT_EQ(nearest_name("diamater", names), "diameter");
    EXPECT_EQ(nearest_name("tehrads", names), "threads");
    EXPECT_EQ(nearest_name("dia", names), "diameter");
    EXPECT_EQ(nearest_name("colour", names), "");
    EXPECT_EQ(nearest_name("", names), "");
    EXPECT_EQ(nearest_name("x", {}), "");
}

}  // namespace
}  // namespace grainfield
