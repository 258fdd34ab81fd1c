#include "report/run_labels.h"

#include <gtest/gtest.h>

namespace grainfield::report {
namespace {

TEST(Identities, AreThoseOfTheRuns) {
    std::vector<Results> runs(2);
    runs[1].identity.origin = Origin::md;
    EXPECT_EQ(identities_of(runs), (std::vector<RunIdentity>{{}, {.origin = Origin::md}}));
}

TEST(Origins, ComeInOrderOfAppearanceWithoutCriticalPoints) {
    const std::vector<RunIdentity> identities{
        {.origin = Origin::md},
        {.origin = Origin::video, .role = RunRole::critical_point},
        {.origin = Origin::video},
        {.origin = Origin::md}};
    EXPECT_EQ(origins_of(identities), (std::vector<std::string>{"MD", "tracked"}));
    EXPECT_EQ(origin_text(identities[0]), "MD");
    EXPECT_EQ(origin_text(identities[1]), "critical");
}

TEST(Identities, AreAllOnALineWhereNothingElseIsThere) {
    const RunIdentity line{.origin = Origin::field, .dimension = 1};
    EXPECT_TRUE(all_on_a_line({line, line}));
    EXPECT_FALSE(all_on_a_line({line, {.origin = Origin::md}}));
    EXPECT_FALSE(all_on_a_line({}));
    const RunIdentity critical{.origin = Origin::field, .role = RunRole::critical_point};
    EXPECT_TRUE(all_on_a_line({critical, line})) << "what is made of runs is none";
    EXPECT_FALSE(all_on_a_line({critical}));
}

}  // namespace
}  // namespace grainfield::report
