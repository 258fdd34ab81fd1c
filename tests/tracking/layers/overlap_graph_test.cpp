#include "tracking/layers/overlap_graph.h"

#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "core/errors.h"
#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

constexpr SphereCell kCell{.diameter = 10, .height = 1.94};

std::vector<Vec2> random_points(std::size_t n, double side) {
    RandomStream random(1, "points");
    std::vector<Vec2> points(n);
    for (Vec2& p : points) p = {random.uniform(-20, side), random.uniform(5, side)};
    return points;
}

TEST(OverlapGraph, HoldsEveryOverlapAndItsLeastDifferenceOfHeight) {
    const auto points = random_points(300, 200);
    std::vector<Vec2> errors(points.size());
    RandomStream random(2, "errors");
    for (Vec2& e : errors) e = {random.uniform(0, 0.3), random.uniform(0, 0.3)};
    const OverlapGraph graph(kCell, points, errors);
    std::map<std::pair<std::uint32_t, std::uint32_t>, OverlapPair> found;
    for (const OverlapPair& pair : graph.pairs()) found[{pair.first, pair.second}] = pair;
    EXPECT_EQ(found.size(), graph.pairs().size());
    std::size_t expected = 0;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        for (std::uint32_t j = i + 1; j < points.size(); ++j) {
            const Vec2 step = points[j] - points[i];
            const double d = norm(step);
            const double sigma =
                std::sqrt((std::pow(errors[i].x, 2) + std::pow(errors[j].x, 2)) * step.x * step.x +
                          (std::pow(errors[i].y, 2) + std::pow(errors[j].y, 2)) * step.y * step.y) /
                d;
            const double near = (d + 3 * sigma) / 10;
            if (d / 10 >= 1 - 1e-6) continue;
            ++expected;
            ASSERT_TRUE(found.contains({i, j}));
            const OverlapPair& pair = found[{i, j}];
            EXPECT_NEAR(pair.distance, d / 10, 1e-12);
            EXPECT_NEAR(pair.distance_error, sigma / 10, 1e-12);
            EXPECT_NEAR(pair.rise, near < 1 - 1e-6 ? std::sqrt(1 - near * near) : 0, 1e-6);
            const double sure = (d + 4 * sigma) / 10;
            EXPECT_NEAR(pair.sure_rise, sure < 1 - 1e-6 ? std::sqrt(1 - sure * sure) : 0, 1e-6);
        }
    }
    EXPECT_EQ(found.size(), expected);
    EXPECT_GT(expected, 200u);
}

// Pairs drawn with heights uniform within the halves of the cell, kept where they do not overlap in
// space: among those at one distance, how many lie on opposite sides.
TEST(OverlapGraph, TheOddsForOppositeSidesAreThoseOfSpheresAtRandomHeights) {
    RandomStream random(3, "heights");
    constexpr double kSlack = 0.94;
    for (const double distance : {0.6, 0.89, 0.93, 0.97, 0.995}) {
        for (const double error : {0.0, 0.02}) {
            double opposite = 0;
            double alike = 0;
            for (int k = 0; k < 400000; ++k) {
                const double one = random.uniform(0, kSlack);
                const double other = random.uniform(0, kSlack);
                const double d = distance + error * random.normal();
                if (d < 1 && std::abs(one - other) < std::sqrt(1 - d * d)) continue;
                ((one > kSlack / 2) != (other > kSlack / 2) ? opposite : alike) += 1;
            }
            const double share = 1 / 200000.0;
            EXPECT_NEAR(opposite_log_odds(distance, error, kSlack),
                        std::log((1e-3 + share * opposite) / (1e-3 + share * alike)), 0.15)
                << distance << " " << error;
        }
    }
    EXPECT_EQ(opposite_log_odds(0.8, 0, 0), 0);
    // δ = .866 a of .94 a: 2 (1 − δ/H)² = .0124 beside .001.
    EXPECT_NEAR(opposite_log_odds(0.5, 0, kSlack), 2.59, 0.01);
}

TEST(OverlapGraph, LinksAreThePairsSeenFromEitherEnd) {
    const OverlapGraph graph(kCell, random_points(100, 100), {});
    std::size_t links = 0;
    for (std::uint32_t i = 0; i < graph.size(); ++i) {
        for (const auto link : graph.links(i)) {
            const OverlapPair& pair = graph.pairs()[link.pair];
            EXPECT_TRUE((pair.first == i && pair.second == link.sphere) ||
                        (pair.second == i && pair.first == link.sphere));
            ++links;
        }
    }
    EXPECT_EQ(links, 2 * graph.pairs().size());
}

TEST(OverlapGraph, ASphereOfUnknownErrorTakesPartInNoPair) {
    const std::vector<Vec2> points{{0, 0}, {5, 0}, {9, 0}};
    const OverlapGraph graph(kCell, points, {{0, 0}, {NAN, 0}, {0, 0}});
    ASSERT_EQ(graph.pairs().size(), 1u);
    EXPECT_EQ(graph.pairs()[0].second, 2u);
}

TEST(OverlapGraph, RefusesACellLowerThanASphereAndPositionsThatAreNone) {
    const std::vector<Vec2> one{{1, 1}};
    EXPECT_THROW(OverlapGraph({10, 0.9}, one, {}), OptionError);
    EXPECT_THROW(OverlapGraph({0, 1.94}, one, {}), OptionError);
    EXPECT_THROW(OverlapGraph(kCell, {{NAN, 1}}, {}), InputError);
    EXPECT_THROW(OverlapGraph(kCell, one, {{0, 0}, {0, 0}}), InputError);
    EXPECT_EQ(OverlapGraph(kCell, {}, {}).size(), 0u);
}

}  // namespace
}  // namespace grainfield::tracking
