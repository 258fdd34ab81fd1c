#include "tracking/link/candidates.h"

#include <cmath>
#include <limits>
#include <set>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

const std::vector<Vec2> kNoErrors;

std::vector<Vec2> scattered(std::size_t count, double width, double height, RandomStream& random) {
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < count; ++i) {
        points.push_back({random.uniform(-5, width), random.uniform(-5, height)});
    }
    return points;
}

TEST(Candidates, AreAllPairsWithinTheRange) {
    RandomStream random(1, "candidates");
    for (const double range : {0.01, 0.7, 3.0, 500.0}) {
        for (const auto& [tracks, particles] :
             {std::pair(25, 30), std::pair(1, 30), std::pair(30, 1), std::pair(0, 4),
              std::pair(4, 0)}) {
            const auto a = scattered(static_cast<std::size_t>(tracks), 30, 8, random);
            const auto b = scattered(static_cast<std::size_t>(particles), 20, 12, random);
            std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
            for (std::uint32_t i = 0; i < a.size(); ++i) {
                for (std::uint32_t j = 0; j < b.size(); ++j) {
                    if (norm(a[i] - b[j]) <= range) expected.insert({i, j});
                }
            }
            const Candidates found = find_candidates({a, kNoErrors}, {b, kNoErrors}, range, {});
            std::set<std::pair<std::uint32_t, std::uint32_t>> pairs;
            std::uint32_t last = 0;
            for (const AssignmentPair& p : found.pairs) {
                pairs.insert({p.row, p.column});
                EXPECT_GE(p.row, last);
                last = p.row;
                EXPECT_DOUBLE_EQ(p.cost, squared_norm(a[p.row] - b[p.column]));
            }
            EXPECT_EQ(pairs, expected);
            EXPECT_EQ(pairs.size(), found.pairs.size());
            EXPECT_EQ(found.crowded_tracks, 0);
        }
    }
}

TEST(Candidates, ACrowdIsLimitedToTheNearestAndCounted) {
    std::vector<Vec2> particles;
    for (int i = 0; i < 500; ++i) particles.push_back({0.01 * (i * 7 % 500), 0});
    const std::vector<Vec2> tracks{{0, 0}, {1000, 0}};
    const Candidates found = find_candidates({tracks, kNoErrors}, {particles, kNoErrors}, 10, {});
    EXPECT_EQ(found.crowded_tracks, 1);
    ASSERT_EQ(found.pairs.size(), 32u);
    for (const AssignmentPair& p : found.pairs) EXPECT_LT(particles[p.column].x, 0.315);
}

TEST(Candidates, PlacesFarOutsideFindNothing) {
    const std::vector<Vec2> particles{{0, 0}, {10, 10}};
    const std::vector<Vec2> tracks{{1e300, 0}, {0, -1e300}, {-1e9, -1e9}, {40, 5}, {5, 40}};
    EXPECT_TRUE(find_candidates({tracks, kNoErrors}, {particles, kNoErrors}, 3, {}).pairs.empty());
}

TEST(StepCost, IsTheSquaredStepWhenAllErrorsAreEqualOrUnknown) {
    const Vec2 step{1.5, -2};
    EXPECT_DOUBLE_EQ(StepCost{}(step, {9, 9}, {1, 1}), 6.25);
    const StepCost cost{.motion = 0.7, .squared_error = 0.09};
    EXPECT_NEAR(cost(step, {0.3, 0.3}, {0.3, 0.3}), 6.25, 1e-12);
}

TEST(StepCost, IsTheLogLikelihoodOfTheStepScaled) {
    // −2 ln of the Gaussian density of the step, relative to that of typical errors at rest.
    const StepCost cost{.motion = 0.5, .squared_error = 0.04};
    const Vec2 step{1, 2}, track{0.1, 0.4}, particle{0.7, 0.2};
    const auto density = [](double x, double variance) {
        return std::exp(-x * x / (2 * variance)) / std::sqrt(variance);
    };
    const double vx = 0.5 + 0.01 + 0.49;
    const double vy = 0.5 + 0.16 + 0.04;
    const double typical = 0.58;
    const double likelihood = density(1, vx) * density(2, vy) * typical;
    EXPECT_NEAR(cost(step, track, particle), -2 * typical * std::log(likelihood), 1e-12);
}

}  // namespace
}  // namespace grainfield::tracking
