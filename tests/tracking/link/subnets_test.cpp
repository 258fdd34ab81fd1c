#include "tracking/link/subnets.h"

#include <algorithm>
#include <functional>
#include <set>

#include <gtest/gtest.h>

#include "core/support/random.h"
#include "tracking/link/candidates.h"

namespace grainfield::tracking {
namespace {

constexpr std::int64_t kUnlimited = 1'000'000;
const std::vector<Vec2> kNoErrors;

std::vector<AssignmentPair> pairs_of(const std::vector<Vec2>& tracks,
                                     const std::vector<Vec2>& particles, double range) {
    return find_candidates({tracks, kNoErrors}, {particles, kNoErrors}, range, {}).pairs;
}

std::vector<Vec2> scattered(std::size_t count, double size, RandomStream& random) {
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < count; ++i) {
        points.push_back({random.uniform(0, size), random.uniform(0, size)});
    }
    return points;
}

double cost(const std::vector<std::int32_t>& links, const std::vector<Vec2>& tracks,
            const std::vector<Vec2>& particles, double range) {
    std::set<std::int32_t> used;
    double sum = 0;
    for (std::size_t t = 0; t < links.size(); ++t) {
        if (links[t] < 0) {
            sum += range * range;
            continue;
        }
        EXPECT_TRUE(used.insert(links[t]).second);
        const double d2 = squared_norm(particles[static_cast<std::size_t>(links[t])] - tracks[t]);
        EXPECT_LE(d2, range * range);
        sum += d2;
    }
    return sum;
}

double least_cost(const std::vector<Vec2>& tracks, const std::vector<Vec2>& particles,
                  double range) {
    std::vector<char> taken(particles.size(), 0);
    const std::function<double(std::size_t)> from = [&](std::size_t t) -> double {
        if (t == tracks.size()) return 0;
        double best = range * range + from(t + 1);
        for (std::size_t p = 0; p < particles.size(); ++p) {
            const double d2 = squared_norm(particles[p] - tracks[t]);
            if (taken[p] || d2 > range * range) continue;
            taken[p] = 1;
            best = std::min(best, d2 + from(t + 1));
            taken[p] = 0;
        }
        return best;
    };
    return from(0);
}

TEST(Subnets, LinksAreTheBestOfAllChoices) {
    RandomStream random(1, "subnets");
    for (int trial = 0; trial < 500; ++trial) {
        const auto tracks = scattered(random.below(8), 10, random);
        const auto particles = scattered(random.below(8), 10, random);
        const double range = random.uniform(1, 6);
        SubnetCounts counts;
        const auto links = choose_links(
            pairs_of(tracks, particles, range), static_cast<std::uint32_t>(tracks.size()),
            static_cast<std::uint32_t>(particles.size()), range * range, kUnlimited, counts);
        ASSERT_NEAR(cost(links, tracks, particles, range), least_cost(tracks, particles, range),
                    1e-10);
        EXPECT_EQ(counts.reduced, 0);
    }
}

TEST(Subnets, AreCountedWithTheirSizes) {
    // A pair alone, two tracks at one particle, and a chain of three tracks and two particles.
    const std::vector<Vec2> tracks{{0, 0}, {50, 0}, {53, 0}, {100, 0}, {104, 0}, {108, 0}};
    const std::vector<Vec2> particles{{1, 0}, {51, 0}, {102, 0}, {106, 0}};
    SubnetCounts counts;
    choose_links(pairs_of(tracks, particles, 3), 6, 4, 9, kUnlimited, counts);
    EXPECT_EQ(counts.subnets, 2);
    EXPECT_EQ(counts.largest, 3);
    EXPECT_EQ(counts.largest_pairs, 4);
}

TEST(Subnets, TooLargeOnesAreCutAndStayCloseToTheOptimum) {
    RandomStream random(2, "subnets");
    const auto tracks = scattered(2000, 100, random);
    std::vector<Vec2> particles = tracks;
    for (Vec2& p : particles) p += 0.4 * Vec2{random.normal(), random.normal()};
    const double range = 6;  // about 25 particles in reach: one subnet of everything
    const auto pairs = pairs_of(tracks, particles, range);
    SubnetCounts whole;
    const auto best = choose_links(pairs, 2000, 2000, range * range, kUnlimited, whole);
    EXPECT_EQ(whole.reduced, 0);
    EXPECT_EQ(whole.largest, 2000);
    const double optimum = cost(best, tracks, particles, range);
    for (const std::int64_t limit : {1, 100, 2000}) {
        SubnetCounts counts;
        const auto links = choose_links(pairs, 2000, 2000, range * range, limit, counts);
        EXPECT_EQ(counts.reduced, 1);
        const double found = cost(links, tracks, particles, range);
        EXPECT_GE(found, optimum - 1e-9);
        // Almost all links are found; the rest is what cutting costs.
        EXPECT_LE(std::count(links.begin(), links.end(), -1), 40) << limit;
        std::int64_t same = 0;
        for (std::size_t i = 0; i < links.size(); ++i) same += links[i] == best[i];
        EXPECT_GE(same, limit == 1 ? 1700 : 1900) << limit;
    }
}

TEST(Subnets, AllOnOnePointEndsAndLinksEveryTrack) {
    std::vector<AssignmentPair> pairs;
    for (std::uint32_t t = 0; t < 200; ++t) {
        for (std::uint32_t p = 0; p < 200; ++p) pairs.push_back({t, p, 0.0});
    }
    SubnetCounts counts;
    const auto links = choose_links(pairs, 200, 200, 1, 50, counts);
    EXPECT_EQ(counts.reduced, 1);
    EXPECT_EQ(std::count(links.begin(), links.end(), -1), 0);
}

}  // namespace
}  // namespace grainfield::tracking
