#include "io/images/file_numbering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::io {
namespace {

using ::testing::ElementsAre;

TEST(FileNumbering, PutsTwoBeforeTen) {
    EXPECT_TRUE(natural_less("f2", "f10"));
    EXPECT_FALSE(natural_less("f10", "f2"));
    EXPECT_TRUE(natural_less("f009", "f10"));
    EXPECT_TRUE(natural_less("a2b10", "a10b2"));
    EXPECT_TRUE(natural_less("f", "f1"));
    EXPECT_FALSE(natural_less("f1", "f1"));
    EXPECT_TRUE(natural_less("f99999999999999999999998", "f99999999999999999999999"));
    EXPECT_NE(natural_less("f01", "f1"), natural_less("f1", "f01"));
}

TEST(FileNumbering, OpensAGapForEachAbsentNumber) {
    const auto found = number_files({"d/a001.tif", "d/a004.tif", "d/a002.tif"});
    EXPECT_THAT(found.files, ElementsAre("d/a001.tif", "d/a002.tif", "", "d/a004.tif"));
    EXPECT_THAT(found.missing_names, ElementsAre("d/a003.tif"));
    EXPECT_TRUE(found.warnings.empty());
    EXPECT_THAT(number_files({"p/a1", "q/a3", "q/a4"}).missing_names, ElementsAre("p/a2"));
}

TEST(FileNumbering, SeesOnlyTheRunningNumber) {
    const auto found = number_files({"run7_08.tif", "run7_10.tif", "run7_11.tif"});
    EXPECT_THAT(found.missing_names, ElementsAre("run7_09.tif"));
}

TEST(FileNumbering, TakesEvenStepsAsComplete) {
    EXPECT_EQ(number_files({"a0", "a10", "a20", "a30"}).files.size(), 4U);
    EXPECT_THAT(number_files({"a0", "a10", "a30"}).missing_names, ElementsAre("a20"));
}

TEST(FileNumbering, LeavesGapsAloneWhereNamesAreNoSequence) {
    EXPECT_EQ(number_files({"a1_1", "a2_3", "a3_4"}).files.size(), 3U);  // two numbers change
    EXPECT_EQ(number_files({"p/a1", "p/a4", "q/a3"}).files.size(), 3U);  // begin anew
    EXPECT_EQ(number_files({"a1", "b3", "b4"}).files.size(), 3U);        // two words
    const auto stamps = number_files({"t1000", "t1997", "t3002"});       // times, not numbers
    EXPECT_EQ(stamps.files.size(), 3U);
    EXPECT_EQ(stamps.warnings.size(), 1U);
    EXPECT_EQ(number_files({"a1"}).files.size(), 1U);
}

TEST(FileNumbering, SaysWhenItChangesTheOrderOfFreeNames) {
    EXPECT_EQ(number_files({"b", "a"}).warnings.size(), 1U);
    EXPECT_TRUE(number_files({"a", "b"}).warnings.empty());
}

TEST(FileNumbering, RefusesAFileGivenTwice) {
    EXPECT_THROW(number_files({"a1", "a2", "a1"}), InputError);
}

}  // namespace
}  // namespace grainfield::io
