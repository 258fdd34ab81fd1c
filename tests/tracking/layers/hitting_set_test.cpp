#include "tracking/layers/hitting_set.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

using Sets = std::vector<std::vector<std::uint32_t>>;

double lightest_by_trying_all(const Sets& sets, const std::vector<double>& weight) {
    double least = 1e300;
    for (std::uint32_t choice = 0; choice < (1U << weight.size()); ++choice) {
        const bool meets_all = std::all_of(sets.begin(), sets.end(), [&](const auto& set) {
            return std::any_of(set.begin(), set.end(),
                               [&](auto e) { return (choice >> e & 1U) != 0; });
        });
        if (!meets_all) continue;
        double sum = 0;
        for (std::uint32_t e = 0; e < weight.size(); ++e) {
            if ((choice >> e & 1U) != 0) sum += weight[e];
        }
        least = std::min(least, sum);
    }
    return least;
}

TEST(HittingSet, IsTheLightestOfAllThatMeetEverySet) {
    RandomStream random(5, "hitting set");
    for (int trial = 0; trial < 200; ++trial) {
        const auto elements = 4 + static_cast<std::uint32_t>(random.uniform(0, 8));
        std::vector<double> weight(elements);
        for (double& w : weight) w = random.uniform(0.1, 1);
        Sets sets(1 + static_cast<std::size_t>(random.uniform(0, 9)));
        for (auto& set : sets) {
            const double share = random.uniform(0.1, 0.6);
            for (std::uint32_t e = 0; e < elements; ++e) {
                if (random.uniform(0, 1) < share) set.push_back(e);
            }
            if (set.empty()) set.push_back(static_cast<std::uint32_t>(trial) % elements);
        }
        const HittingSet found = minimum_hitting_set(sets, weight);
        ASSERT_TRUE(found.exact);
        ASSERT_TRUE(std::is_sorted(found.members.begin(), found.members.end()));
        double sum = 0;
        for (const auto e : found.members) sum += weight[e];
        for (const auto& set : sets) {
            EXPECT_TRUE(std::any_of(set.begin(), set.end(), [&](auto e) {
                return std::binary_search(found.members.begin(), found.members.end(), e);
            }));
        }
        EXPECT_NEAR(sum, lightest_by_trying_all(sets, weight), 1e-12) << trial;
    }
}

TEST(HittingSet, WithoutBudgetStillMeetsEverySetAndSaysThatItMayNotBeTheLightest) {
    Sets sets;
    for (std::uint32_t i = 0; i < 40; ++i) sets.push_back({i, (i + 1) % 40, (i + 7) % 40});
    const HittingSet found = minimum_hitting_set(sets, std::vector<double>(40, 1.0), 1);
    EXPECT_FALSE(found.exact);
    for (const auto& set : sets) {
        EXPECT_TRUE(std::any_of(set.begin(), set.end(), [&](auto e) {
            return std::binary_search(found.members.begin(), found.members.end(), e);
        }));
    }
}

TEST(HittingSet, OfNothingIsEmpty) {
    EXPECT_TRUE(minimum_hitting_set({}, {1, 2}).members.empty());
}

}  // namespace
}  // namespace grainfield::tracking
