#include "tracking/point_grid.h"

#include <algorithm>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

std::vector<Vec2> scattered(std::size_t count, double width, double height) {
    RandomStream random(11, "points");
    std::vector<Vec2> points;
    for (std::size_t i = 0; i < count; ++i) {
        points.push_back({random.uniform(0, width), random.uniform(0, height)});
    }
    return points;
}

std::set<std::uint32_t> nearer(const std::vector<Vec2>& points, Vec2 p, double distance) {
    std::set<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < points.size(); ++i) {
        if (norm(points[i] - p) < distance) expected.insert(i);
    }
    return expected;
}

TEST(PointGrid, FindsAllPointsNearerThanTheDistance) {
    const std::vector<Vec2> points = scattered(300, 60, 25);
    for (const double distance : {0.02, 1.7, 6.0, 100.0}) {
        const PointGrid whole(points, distance);
        PointGrid filled(60, 25, distance);
        for (std::uint32_t i = 0; i < points.size(); ++i) filled.add(points[i], i);
        // From inside and from far outside.
        for (const Vec2 p :
             {points[7], Vec2{30, 12}, Vec2{-0.5, 25.4}, Vec2{-1e9, 3}, Vec2{8, 1e12}}) {
            const std::set<std::uint32_t> expected = nearer(points, p, distance);
            for (const PointGrid* grid : {&std::as_const(whole), &std::as_const(filled)}) {
                std::set<std::uint32_t> found;
                grid->near(p, distance, [&](std::uint32_t i, Vec2 at) {
                    EXPECT_TRUE(found.insert(i).second);
                    EXPECT_EQ(at.x, points[i].x);
                });
                EXPECT_EQ(found, expected) << distance;
                EXPECT_EQ(grid->any(p, distance), !expected.empty());
            }
        }
    }
}

TEST(PointGrid, VisitsEachPairOnce) {
    const std::vector<Vec2> points = scattered(200, 40, 30);
    for (const double distance : {0.5, 3.0, 80.0}) {
        std::set<std::pair<std::uint32_t, std::uint32_t>> expected;
        for (std::uint32_t i = 0; i < points.size(); ++i) {
            for (std::uint32_t j = i + 1; j < points.size(); ++j) {
                if (norm(points[i] - points[j]) < distance) expected.insert({i, j});
            }
        }
        std::set<std::pair<std::uint32_t, std::uint32_t>> found;
        PointGrid(points, distance)
            .each_pair(distance, [&](std::uint32_t i, std::uint32_t j, double square) {
                EXPECT_TRUE(found.insert({std::min(i, j), std::max(i, j)}).second);
                EXPECT_DOUBLE_EQ(square, squared_norm(points[i] - points[j]));
            });
        EXPECT_EQ(found, expected) << distance;
    }
}

// Sums over neighbours are rounded in this order: results depend on it to the last bit.
TEST(PointGrid, GivesPointsOfACellInTheirOrderAndAddedOnesFirst) {
    const std::vector<Vec2> points{{1, 1}, {2, 1}, {1, 2}};
    PointGrid grid(points, 10);
    grid.add({1.5, 1.5}, 3);
    grid.add({1.5, 1.2}, 4);
    std::vector<std::uint32_t> order;
    grid.around({1, 1}, [&](std::uint32_t i, Vec2) { order.push_back(i); });
    EXPECT_EQ(order, (std::vector<std::uint32_t>{4, 3, 0, 1, 2}));
}

TEST(PointGrid, OfNothingFindsNothing) {
    EXPECT_FALSE(PointGrid(std::vector<Vec2>{}, 3).any({1, 1}, 3));
    EXPECT_FALSE(PointGrid(5, 5, 3).any({1, 1}, 3));
}

}  // namespace
}  // namespace grainfield::tracking
