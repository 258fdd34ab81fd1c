#include "tracking/layers/joined_sides.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

bool opposite(const JoinedSides& sides, std::size_t i, std::size_t j) {
    EXPECT_EQ(sides.group[i], sides.group[j]);
    return sides.turned[i] != sides.turned[j];
}

TEST(JoinedSides, WeakLinksJoinTogetherWhatNoneOfThemJoins) {
    // Two pairs, each sure; three links of 7 to 1 between them say how they are turned.
    const std::vector<SideLink> links{{0, 1, 6}, {2, 3, 6}, {1, 2, 2}, {0, 3, 2}, {0, 2, -2}};
    const JoinedSides sides = join_sides(4, links, 4.6);
    EXPECT_TRUE(opposite(sides, 0, 1));
    EXPECT_TRUE(opposite(sides, 1, 2));
    EXPECT_FALSE(opposite(sides, 0, 2));
    const JoinedSides apart = join_sides(4, {{0, 1, 6}, {2, 3, 6}, {1, 2, 2}}, 4.6);
    EXPECT_NE(apart.group[0], apart.group[2]);
}

TEST(JoinedSides, TheWeakestLinkOfARingThatContradictsItselfIsOverruled) {
    const JoinedSides sides = join_sides(3, {{0, 1, 6}, {1, 2, 6.5}, {0, 2, 1}}, 4.6);
    EXPECT_TRUE(opposite(sides, 0, 1));
    EXPECT_TRUE(opposite(sides, 1, 2));
    EXPECT_FALSE(opposite(sides, 0, 2));
}

// 1 joins 0 first. Then 4 and 5 join, and what they say of 1 contradicts what 0 says: it is cut
// out. 3 hangs on it alone.
TEST(JoinedSides, AMemberWhoseLinksContradictEachOtherIsCutOutWithWhatHangsOnItAlone) {
    std::vector<SideLink> links{{0, 1, 6.8}, {1, 3, 6.7}, {0, 2, -6.5}};
    for (const std::uint32_t k : {4U, 5U}) {
        links.push_back({0, k, 5});
        links.push_back({2, k, 6});
        links.push_back({1, k, 6});
    }
    const JoinedSides sides = join_sides(6, links, 4.6);
    EXPECT_FALSE(opposite(sides, 0, 2));
    EXPECT_TRUE(opposite(sides, 0, 4));
    EXPECT_TRUE(opposite(sides, 0, 5));
    EXPECT_NE(sides.group[1], sides.group[0]);
    EXPECT_NE(sides.group[3], sides.group[0]);
    EXPECT_EQ(sides.turned[1], 0);
}

TEST(JoinedSides, WhatACutLeavesApartIsTwoGroups) {
    // Two sure pairs, and one between them whose links say hardly more than nothing together.
    const JoinedSides sides =
        join_sides(5, {{0, 1, 6}, {2, 3, 6}, {1, 4, 5}, {4, 2, 5}, {0, 4, 4}, {3, 4, 3}}, 4.6);
    EXPECT_TRUE(opposite(sides, 0, 1));
    EXPECT_TRUE(opposite(sides, 2, 3));
    EXPECT_NE(sides.group[0], sides.group[2]);
    for (const std::size_t i : {0UL, 1UL, 2UL, 3UL}) EXPECT_NE(sides.group[i], sides.group[4]);
}

TEST(JoinedSides, SidesThatAreThereAreFoundThroughLinksOfWhichSomeAreWrong) {
    constexpr std::size_t side = 40;
    RandomStream random(1, "sides");
    std::vector<char> truth(side * side);
    for (char& t : truth) t = random.uniform(0, 1) < 0.5 ? 1 : 0;
    std::vector<SideLink> links;
    const auto link = [&](std::size_t i, std::size_t j) {
        // What is said with odds of e³ is wrong once in e³ + 1.
        const bool lie = random.uniform(0, 1) < 1 / (std::exp(3.0) + 1);
        const double weight = (truth[i] != truth[j]) != lie ? 3 : -3;
        links.push_back({static_cast<std::uint32_t>(i), static_cast<std::uint32_t>(j), weight});
    };
    for (std::size_t y = 0; y + 2 < side; ++y) {
        for (std::size_t x = 0; x + 2 < side; ++x) {
            const std::size_t i = y * side + x;
            for (const std::size_t j : {i + 1, i + side, i + side + 1, i + 2}) link(i, j);
        }
    }
    const JoinedSides sides = join_sides(truth.size(), links, 2.9);
    const std::uint32_t group = sides.group[side * side / 2 + side / 2];
    std::size_t members = 0;
    std::size_t agree = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (sides.group[i] != group) continue;
        ++members;
        if (sides.turned[i] != truth[i]) ++agree;
    }
    const std::size_t wrong = std::min(agree, members - agree);
    EXPECT_GT(members, 1300u);
    EXPECT_LT(wrong, members / 100);
}

TEST(JoinedSides, WithoutLinksEachStandsAlone) {
    const JoinedSides sides = join_sides(3, {}, 4.6);
    for (std::uint32_t i = 0; i < 3; ++i) EXPECT_EQ(sides.group[i], i);
}

}  // namespace
}  // namespace grainfield::tracking
