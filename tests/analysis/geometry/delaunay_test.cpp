#include "analysis/geometry/delaunay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

__extension__ using Wide = __int128;

std::vector<GridPoint> random_points(std::size_t n, std::int32_t side, RandomStream& random) {
    std::vector<GridPoint> points;
    for (std::size_t i = 0; i < n; ++i) {
        const auto coordinate = [&] {
            return static_cast<std::int32_t>((2 * random.uniform() - 1) * side);
        };
        points.push_back({coordinate(), coordinate()});
    }
    return points;
}

// Positive if p lies inside the circle through a, b, c: in 128 bits, with coordinates below 2^20.
Wide in_circle(const GridPoint& a, const GridPoint& b, const GridPoint& c, const GridPoint& p) {
    const auto row = [&](const GridPoint& q) {
        const Wide x = q.x - p.x;
        const Wide y = q.y - p.y;
        return std::array<Wide, 3>{x, y, x * x + y * y};
    };
    const auto u = row(a), v = row(b), w = row(c);
    return u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

Wide area(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
    return Wide{b.x - a.x} * (c.y - a.y) - Wide{b.y - a.y} * (c.x - a.x);
}

// Every triangle is counterclockwise and holds no point in its circle, and the triangles fill the
// convex hull.
void expect_delaunay(const std::vector<GridPoint>& points) {
    const Delaunay delaunay(points);
    Wide covered = 0;
    for (int t = 0; t < delaunay.triangles(); ++t) {
        const auto corner = delaunay.corners(t);
        if (corner[0] < 0) continue;
        const auto at = [&](std::size_t k) { return points[static_cast<std::size_t>(corner[k])]; };
        ASSERT_TRUE(area(at(0), at(1), at(2)) > 0);
        covered += area(at(0), at(1), at(2));
        for (const GridPoint& p : points) ASSERT_FALSE(in_circle(at(0), at(1), at(2), p) > 0);
    }
    std::vector<GridPoint> sorted = points;
    std::ranges::sort(sorted, [](const GridPoint& a, const GridPoint& b) {
        return a.x != b.x ? a.x < b.x : a.y < b.y;
    });
    std::vector<GridPoint> hull;  // both chains, closed
    for (int chain = 0; chain < 2; ++chain) {
        const std::size_t from = hull.size();
        for (const GridPoint& p : sorted) {
            while (hull.size() >= from + 2 && !(area(hull[hull.size() - 2], hull.back(), p) > 0)) {
                hull.pop_back();
            }
            hull.push_back(p);
        }
        std::ranges::reverse(sorted);
    }
    Wide wanted = 0;
    for (const GridPoint& p : hull) {
        const GridPoint& q = &p == &hull.back() ? hull.front() : *(&p + 1);
        wanted += area(hull.front(), p, q);
    }
    EXPECT_TRUE(covered == wanted);
}

TEST(Delaunay, HasEmptyCirclesAndFillsTheHull) {
    RandomStream random(1, "delaunay");
    for (const std::size_t n : {3U, 4U, 7U, 30U, 250U}) {
        for (int trial = 0; trial < 10; ++trial) {
            expect_delaunay(random_points(n, 1 << 19, random));
        }
    }
}

// Few places for many points: collinear, cocircular and coinciding ones everywhere.
TEST(Delaunay, IsExactWherePointsLieOnLinesOnCirclesAndOnEachOther) {
    RandomStream random(2, "degenerate");
    for (const std::int32_t side : {2, 3, 5, 9}) {
        for (const std::size_t n : {5U, 20U, 120U}) {
            for (int trial = 0; trial < 10; ++trial) {
                expect_delaunay(random_points(n, side, random));
            }
        }
    }
    std::vector<GridPoint> lattice;
    for (int y = 0; y < 15; ++y) {
        for (int x = 0; x < 15; ++x) lattice.push_back({1000 * x, 1000 * y});
    }
    expect_delaunay(lattice);
    // The twelve points of a circle of radius 5, its centre, and a line through it.
    std::vector<GridPoint> circle{{5, 0},  {4, 3},   {3, 4},   {0, 5},  {-3, 4}, {-4, 3},
                                  {-5, 0}, {-4, -3}, {-3, -4}, {0, -5}, {3, -4}, {4, -3}};
    expect_delaunay(circle);
    for (int x = -9; x < 10; ++x) circle.push_back({x, 0});
    expect_delaunay(circle);
}

TEST(Delaunay, SharesEveryEdgeBetweenBothOfItsEnds) {
    RandomStream random(3, "spokes");
    const std::vector<GridPoint> points = random_points(2000, Delaunay::most, random);
    const Delaunay delaunay(points);
    std::set<std::pair<int, int>> edges;
    std::vector<Delaunay::Spoke> spokes;
    std::size_t hull = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        delaunay.around(i, spokes);
        for (const Delaunay::Spoke& spoke : spokes) {
            EXPECT_TRUE(edges.insert({static_cast<int>(i), spoke.to}).second);
            hull += spoke.left < 0;
            for (const int t : {spoke.left, spoke.right}) {
                if (t < 0) continue;
                const auto corner = delaunay.corners(t);
                EXPECT_EQ(std::ranges::count(corner, static_cast<int>(i)), 1);
                EXPECT_EQ(std::ranges::count(corner, spoke.to), 1);
            }
        }
    }
    for (const auto& [i, j] : edges) EXPECT_TRUE(edges.contains({j, i}));
    EXPECT_EQ(edges.size() / 2, 3 * points.size() - 3 - hull);  // Euler's formula
}

TEST(Delaunay, OfPointsOnALineHasTheNextOnes) {
    std::vector<GridPoint> points;
    for (int i = 0; i < 9; ++i) points.push_back({7 * ((4 * i) % 9), 3 * ((4 * i) % 9)});
    points.push_back(points[2]);
    const Delaunay delaunay(points);
    EXPECT_EQ(delaunay.triangles(), 0);
    std::vector<Delaunay::Spoke> spokes;
    for (std::size_t i = 0; i < points.size(); ++i) {
        delaunay.around(i, spokes);
        const int place = points[i].x / 7;
        std::multiset<int> found, wanted;
        for (const auto& spoke : spokes) {
            found.insert(points[static_cast<std::size_t>(spoke.to)].x / 7);
        }
        if (place > 0) wanted.insert(place - 1);
        if (place < 8) wanted.insert(place + 1);
        EXPECT_EQ(found, wanted);
    }
}

TEST(Delaunay, OfNoneOneAndTwoPointsAndOfOnePlace) {
    EXPECT_EQ(Delaunay({}).triangles(), 0);
    std::vector<Delaunay::Spoke> spokes;
    for (const std::size_t n : {1U, 5U}) {
        const std::vector<GridPoint> same(n, GridPoint{3, -3});
        Delaunay(same).around(n - 1, spokes);
        EXPECT_TRUE(spokes.empty());
    }
    const std::vector<GridPoint> two{{0, 0}, {5, 1}};
    Delaunay(two).around(1, spokes);
    ASSERT_EQ(spokes.size(), 1U);
    EXPECT_EQ(spokes[0].to, 0);
}

// The corners of squares of the whole range: the circle test of doubles cannot decide them.
TEST(Delaunay, IsExactOverTheWholeRange) {
    constexpr std::int32_t most = Delaunay::most;
    const std::vector<GridPoint> points{{-most, -most}, {most, -most},    {most, most},
                                        {-most, most},  {most - 1, most}, {0, 0},
                                        {1, 0},         {most, 0}};
    const Delaunay delaunay(points);
    double covered = 0;
    for (int t = 0; t < delaunay.triangles(); ++t) {
        const auto corner = delaunay.corners(t);
        if (corner[0] < 0) continue;
        const auto at = [&](std::size_t k) { return points[static_cast<std::size_t>(corner[k])]; };
        const auto twice = area(at(0), at(1), at(2));
        EXPECT_TRUE(twice > 0);
        covered += static_cast<double>(twice);
    }
    EXPECT_EQ(covered, 2 * std::pow(2.0 * most, 2));
}

}  // namespace
}  // namespace grainfield::analysis
