#include "analysis/observable_set.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/errors.h"

namespace grainfield::analysis {
namespace {

TEST(ObservableSet, IsReadFromACommaList) {
    const ObservableSet set = ObservableSet::parse(" q4, sk ");
    EXPECT_TRUE(set.q4 && set.sk);
    EXPECT_FALSE(set.phase || set.msd || set.variance);
    const ObservableSet all = ObservableSet::parse("all");
    EXPECT_TRUE(all.q4 && all.phase && all.msd && all.sk && all.variance);
}

TEST(ObservableSet, RefusesUnknownNamesWithTheNearestOne) {
    try {
        ObservableSet::parse("q4,varience");
        FAIL() << "accepted";
    } catch (const OptionError& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("did you mean variance"));
        EXPECT_THAT(error.what(), testing::HasSubstr("'varience'"));
    }
    EXPECT_THROW(ObservableSet::parse(" , "), OptionError);
}

}  // namespace
}  // namespace grainfield::analysis
