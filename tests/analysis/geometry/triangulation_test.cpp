#include "analysis/geometry/triangulation.h"

#include <cmath>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;
using Edges = std::set<std::pair<int, int>>;

Edges edges(const Triangulation& t) {
    Edges set;
    for (std::size_t i = 0; i < t.size(); ++i) {
        for (const Neighbour& n : t.neighbours(i)) {
            set.insert({static_cast<int>(i), n.index});
        }
    }
    return set;
}

// All pairs that share a triangle whose circumcircle holds no other point.
Edges empty_circle_edges(const std::vector<Vec2>& p) {
    Edges set;
    const int n = static_cast<int>(p.size());
    const auto at = [&](int i) { return p[static_cast<std::size_t>(i)]; };
    for (int a = 0; a < n; ++a) {
        for (int b = a + 1; b < n; ++b) {
            for (int c = b + 1; c < n; ++c) {
                const Vec2 u = at(b) - at(a);
                const Vec2 v = at(c) - at(a);
                const double twice = 2 * (u.x * v.y - u.y * v.x);
                const Vec2 centre{(v.y * squared_norm(u) - u.y * squared_norm(v)) / twice,
                                  (u.x * squared_norm(v) - v.x * squared_norm(u)) / twice};
                const double r2 = squared_norm(centre);
                bool empty = true;
                for (int d = 0; d < n && empty; ++d) {
                    if (d == a || d == b || d == c) continue;
                    empty = squared_norm(at(d) - at(a) - centre) > r2;
                }
                if (!empty) continue;
                for (const auto& [i, j] : {std::pair{a, b}, {b, c}, {a, c}}) {
                    set.insert({i, j});
                    set.insert({j, i});
                }
            }
        }
    }
    return set;
}

TEST(Triangulation, HoldsExactlyThePairsOfEmptyCircumcircles) {
    RandomStream random(5, "triangulation");
    const Box box = square_box(10, Boundary::walls);
    for (int trial = 0; trial < 20; ++trial) {
        const std::vector<Vec2> points = poisson_points(40, box, random);
        EXPECT_EQ(edges(Triangulation(points, box)), empty_circle_edges(points));
    }
}

TEST(Triangulation, OfAPeriodicPatternHasThreeEdgesAPointAndIsTranslationInvariant) {
    RandomStream random(6, "periodic");
    for (const std::size_t n : {5U, 12U, 60U, 500U}) {
        const Box box = square_box(std::sqrt(static_cast<double>(n)));
        std::vector<Vec2> points = poisson_points(n, box, random);
        const Triangulation before(points, box);
        std::size_t total = 0;
        for (std::size_t i = 0; i < n; ++i) total += before.neighbours(i).size();
        EXPECT_EQ(total, 6 * n);  // Euler's formula on the torus
        for (Vec2& p : points) p = box.wrap(p + Vec2{0.37, -2.9});
        EXPECT_EQ(edges(Triangulation(points, box)), edges(before));
    }
}

TEST(Triangulation, OfAWalledPatternObeysEuler) {
    RandomStream random(7, "euler");
    const Box box = square_box(30, Boundary::walls);
    const std::vector<Vec2> points = poisson_points(1000, box, random);
    const Edges set = edges(Triangulation(points, box));
    // 3 n − 3 − h edges, h points on the convex hull, of about (8/3) ln n in a square.
    EXPECT_LT(set.size() / 2, 3U * 1000 - 3);
    EXPECT_GT(set.size() / 2, 3U * 1000 - 3 - 60);
    for (const auto& [i, j] : set) EXPECT_TRUE(set.contains({j, i}));
}

TEST(Triangulation, OfOneRowOfPointsFollowsTheRow) {
    std::vector<Vec2> points;
    for (int i = 0; i < 9; ++i) points.push_back({1.5 * i, 0.25 * i});
    const Triangulation t(points, square_box(20, Boundary::walls));
    for (std::size_t i = 0; i < 9; ++i) {
        std::set<int> found;
        for (const Neighbour& n : t.neighbours(i)) found.insert(n.index);
        std::set<int> wanted;
        if (i > 0) wanted.insert(static_cast<int>(i) - 1);
        if (i < 8) wanted.insert(static_cast<int>(i) + 1);
        EXPECT_EQ(found, wanted);
    }
}

TEST(Triangulation, GivesDuplicatesTheNeighboursOfTheirTwin) {
    const Box box = square_box(4, Boundary::walls);
    const std::vector<Vec2> points{{1, 1}, {3, 1}, {2, 3}, {3, 1}};
    const Triangulation t(points, box);
    EXPECT_EQ(t.neighbours(1).size(), 2U);
    EXPECT_EQ(t.neighbours(3).size(), 2U);
    EXPECT_EQ(t.neighbours(0).size(), 2U);
}

TEST(Triangulation, HandlesNoneOneTwoAndAllPointsInOnePlace) {
    const Box walls = square_box(4, Boundary::walls);
    EXPECT_EQ(Triangulation({}, walls).size(), 0U);
    EXPECT_TRUE(Triangulation(std::vector<Vec2>{{1, 1}}, walls).neighbours(0).empty());
    const std::vector<Vec2> two{{1, 1}, {2, 2}};
    EXPECT_EQ(Triangulation(two, walls).neighbours(0).size(), 1U);
    const std::vector<Vec2> same(10, Vec2{2, 2});
    EXPECT_TRUE(Triangulation(same, walls).neighbours(4).empty());
    EXPECT_EQ(Triangulation(two, square_box(4)).size(), 2U);
    EXPECT_EQ(Triangulation(std::vector<Vec2>{{1, 1}}, square_box(4)).size(), 1U);
}

TEST(Triangulation, KeepsTheShapeFarFromTheOrigin) {
    RandomStream random(8, "far");
    const Box box = square_box(10, Boundary::walls);
    std::vector<Vec2> points = poisson_points(200, box, random);
    const Edges before = edges(Triangulation(points, box));
    for (Vec2& p : points) p += Vec2{1e6, -1e6};
    EXPECT_EQ(edges(Triangulation(points, square_box(10, Boundary::walls, {1e6, -1e6}))), before);
}

}  // namespace
}  // namespace grainfield::analysis
