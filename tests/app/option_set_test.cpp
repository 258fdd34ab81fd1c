#include "app/option_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace grainfield::app {
namespace {

using testing::ElementsAre;
using testing::Pair;

class OptionSetOfThreeTables : public testing::Test {
 protected:
    int threads_ = 0;
    double bins_ = 20;
    double other_bins_ = 30;
    double range_ = 1;

    OptionSet make() {
        OptionTable common("");
        common.integer("threads", threads_, "-", {0, 8}, "threads");
        OptionTable q4("q4");
        q4.number("bins", bins_, "-", {1, 100}, "bins");
        q4.number("range", range_, "a", {0, 5}, "range");
        OptionTable sk("sk");
        sk.number("bins", other_bins_, "-", {1, 100}, "bins");
        return {"analyze", {common, q4, sk}};
    }
};

TEST_F(OptionSetOfThreeTables, NamesSharedBySectionsGetTheSectionInTheirFlag) {
    EXPECT_THAT(make().flags(), ElementsAre("threads", "q4-bins", "range", "sk-bins"));
}

TEST_F(OptionSetOfThreeTables, TheNamesOfLibrariesBecomeFlags) {
    const OptionSet set = make();
    EXPECT_EQ(set.with_flags("q4.bins is too small; q4.range, too (sk.bins)"),
              "--q4-bins is too small; --range, too (--sk-bins)");
    EXPECT_EQ(set.with_flags("in 'seq4.bins' and q4.bins-of-old nothing is named"),
              "in 'seq4.bins' and q4.bins-of-old nothing is named");
    EXPECT_EQ(set.with_flags("cannot write 'q4.bins.h5', 'runs/q4.bins' and q4.bins_2"),
              "cannot write 'q4.bins.h5', 'runs/q4.bins' and q4.bins_2")
        << "names of files stay";
    EXPECT_EQ(set.with_flags("option 'threads' is too large; threads are few"),
              "--threads is too large; threads are few");
}

TEST_F(OptionSetOfThreeTables, CommandWideOptionsAreFoundAtTheTopAndUnderTheCommand) {
    const OptionSet set = make();
    ASSERT_NE(set.find("", "threads"), nullptr);
    EXPECT_EQ(set.find("analyze", "threads"), set.find("", "threads"));
    EXPECT_EQ(set.find("q4", "threads"), nullptr);
    EXPECT_EQ(set.find("", "bins"), nullptr);
    EXPECT_TRUE(set.has_section("analyze"));
    EXPECT_FALSE(set.has_section("track"));
    EXPECT_THAT(set.sections(), ElementsAre("analyze", "q4", "sk"));
    EXPECT_THAT(set.keys("q4"), ElementsAre("bins", "range"));
}

TEST_F(OptionSetOfThreeTables, ConfigurationShowsPresentValuesUnderTheirSection) {
    const OptionSet set = make();
    set.find("sk", "bins")->option.set_from_text("40");
    EXPECT_EQ(other_bins_, 40);
    EXPECT_EQ(bins_, 20);
    EXPECT_THAT(set.configuration(), ElementsAre(Pair("threads", "0"), Pair("q4.bins", "20"),
                                                 Pair("q4.range", "1"), Pair("sk.bins", "40")));
}

TEST(OptionSet, RecordsNothingThatConcernsOneCallOnly) {
    bool resume = true;
    bool strict = true;
    OptionTable own("");
    own.flag("resume", resume, "go on");
    own.affects(Effect::call);
    own.flag("strict", strict, "fail early");
    own.affects(Effect::work);
    const OptionSet set("track", {own});
    EXPECT_THAT(set.configuration(), ElementsAre(Pair("strict", "true")));
    EXPECT_THAT(set.indifferent(), ElementsAre("strict"));
}

TEST(OptionSet, FindsAnOptionByItsOtherNamesButRecordsItsName) {
    double disc = 9;
    OptionTable calibrate("calibrate");
    calibrate.number("disc-diameter", disc, "px", {0, 99}, "diameter");
    calibrate.also_called("diameter");
    const OptionSet set("track", {calibrate});
    ASSERT_NE(set.find("calibrate", "diameter"), nullptr);
    EXPECT_EQ(set.find("calibrate", "diameter"), set.find("calibrate", "disc-diameter"));
    EXPECT_THAT(set.configuration(), ElementsAre(Pair("calibrate.disc-diameter", "9")));
}

TEST(OptionSet, ANameThatLooksLikeSectionAndNameGetsItsSectionToo) {
    double height = 1, rows = 2, given = 3;
    OptionTable cell("cell");
    cell.number("height", height, "a", {0, 9}, "height");
    OptionTable view("view");
    view.number("height", rows, "px", {0, 9}, "height");
    view.number("cell-height", given, "a", {0, 9}, "height of the cell");
    EXPECT_THAT(OptionSet("validate", {cell, view}).flags(),
                ElementsAre("cell-height", "view-height", "view-cell-height"));
}

TEST(OptionSet, ASectionNamedLikeTheCommandSharesItsKeysWithTheCommandWideOnes) {
    int threads = 0;
    double diameter = 1;
    OptionTable common("");
    common.integer("threads", threads, "-", {0, 8}, "threads");
    OptionTable track("track");
    track.number("sphere-diameter", diameter, "px", {0, 9}, "diameter");
    const OptionSet set("track", {common, track});
    EXPECT_NE(set.find("track", "threads"), nullptr);
    EXPECT_NE(set.find("track", "sphere-diameter"), nullptr);
    EXPECT_EQ(set.find("", "sphere-diameter"), nullptr);
    EXPECT_THAT(set.keys("track"), ElementsAre("threads", "sphere-diameter"));
}

}  // namespace
}  // namespace grainfield::app
