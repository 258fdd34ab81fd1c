#include "analysis/geometry/neighbours.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

std::vector<std::pair<double, int>> brute_force(const std::vector<Vec2>& points, const Box& box,
                                                std::size_t i) {
    std::vector<std::pair<double, int>> found;
    for (std::size_t j = 0; j < points.size(); ++j) {
        const double r2 = squared_norm(box.minimum_image(points[j] - points[i]));
        if (j != i && r2 > 0) found.emplace_back(r2, static_cast<int>(j));
    }
    std::sort(found.begin(), found.end());
    return found;
}

std::set<int> indices(const NeighbourList& neighbours) {
    std::set<int> set;
    for (const Neighbour& n : neighbours) set.insert(n.index);
    return set;
}

void expect_exact(const std::vector<Vec2>& points, const Box& box) {
    const CellList cells(points, box);
    NeighbourList found;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const auto truth = brute_force(points, box, i);
        const std::size_t k = std::min<std::size_t>(4, truth.size());
        const CellList::Reach reach = cells.near(static_cast<int>(i), 4, 1.2, found);
        ASSERT_EQ(static_cast<std::size_t>(reach.count), k);
        double mean = 0;
        for (std::size_t j = 0; j < k; ++j) mean += std::sqrt(truth[j].first);
        if (k > 0) mean /= static_cast<double>(k);
        EXPECT_NEAR(reach.mean_first, mean, 1e-12 * mean);
        std::set<int> wanted;
        for (std::size_t j = 0; j < truth.size(); ++j) {
            if (j < k || std::sqrt(truth[j].first) < 1.2 * mean) wanted.insert(truth[j].second);
        }
        EXPECT_EQ(indices(found), wanted) << "point " << i;

        cells.within(static_cast<int>(i), 1.7, found);
        wanted.clear();
        for (const auto& [r2, j] : truth) {
            if (r2 < 1.7 * 1.7) wanted.insert(j);
        }
        EXPECT_EQ(indices(found), wanted) << "point " << i;
    }
}

TEST(CellList, FindsTheNearestExactlyForAnyBoundaryAndDensity) {
    RandomStream random(3, "cell list");
    for (const Boundary bx : {Boundary::walls, Boundary::periodic}) {
        for (const Boundary by : {Boundary::walls, Boundary::periodic}) {
            for (const std::size_t n : {2U, 3U, 5U, 17U, 300U}) {
                const Box box{{-3, 7}, {15, 11}, {bx, by}, 0};
                expect_exact(poisson_points(n, box, random), box);
            }
        }
    }
}

TEST(CellList, FindsTheNearestAcrossVoidsAndClusters) {
    RandomStream random(4, "clusters");
    const Box box = square_box(1000, Boundary::walls);
    std::vector<Vec2> points = poisson_points(20, box, random);
    for (int i = 0; i < 200; ++i) {
        points.push_back({500 + random.uniform(), 500 + 0.01 * random.uniform()});
    }
    expect_exact(points, box);
}

TEST(CellList, TakesCoincidingPointsAsNoNeighboursOfEachOther) {
    const std::vector<Vec2> points(50, Vec2{1, 1});
    const CellList cells(points, square_box(10, Boundary::walls));
    NeighbourList found;
    EXPECT_EQ(cells.near(0, 4, 1.2, found).count, 0);
    EXPECT_TRUE(found.empty());
}

TEST(CellList, HandlesNoneAndOnePoint) {
    NeighbourList found;
    EXPECT_EQ(CellList({}, square_box(10)).size(), 0U);
    const std::vector<Vec2> one{{3, 3}};
    EXPECT_EQ(CellList(one, square_box(10)).near(0, 4, 0, found).count, 0);
}

TEST(CellList, FindsPointsOnALine) {
    std::vector<Vec2> points;
    for (int i = 0; i < 200; ++i) points.push_back({0.7 * i, 5});
    expect_exact(points, square_box(200, Boundary::walls));
}

TEST(CellList, FindsTheNearestExactlyWherePointsCrowd) {
    RandomStream random(21, "crowd");
    for (const Boundary boundary : {Boundary::walls, Boundary::periodic}) {
        const Box box = square_box(1e6, boundary);
        std::vector<Vec2> clusters;
        for (const Vec2 centre : {Vec2{10, 10}, Vec2{999990, 20}, Vec2{5e5, 7e5}}) {
            for (int i = 0; i < 150; ++i) {
                clusters.push_back(centre + Vec2{9 * random.uniform(), 9 * random.uniform()});
            }
        }
        for (int i = 0; i < 60; ++i) clusters.push_back({8e5, 1e5});
        clusters.push_back({3e5, 1});
        expect_exact(clusters, box);
    }
}

// With cells over the whole extent all but one point share a cell: 1e10 distances, minutes. With a
// tree it is 1e5 searches of a microsecond or so; the bar leaves room for a slow, shared machine.
TEST(CellList, IsNotSlowedDownByOnePointFarOutside) {
    RandomStream random(22, "outlier");
    std::vector<Vec2> points = poisson_points(100000, square_box(316), random);
    points.push_back({1e9, -1e9});
    const auto start = std::chrono::steady_clock::now();
    const CellList cells(points, square_box(316, Boundary::walls));
    NeighbourList found;
    double sum = 0;
    for (int i = 0; i < 100001; ++i) sum += cells.near(i, 4, 1.2, found).nearest;
    const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - start;
    EXPECT_LT(taken.count(), 5);
    // The nearest neighbour of a Poisson point is 0.5/sqrt(density) away, standard deviation
    // 0.26/sqrt(density); edges add a little.
    const double density = 100000 / (316.0 * 316);
    const double far = cells.near(100000, 4, 1.2, found).nearest;
    EXPECT_NEAR((sum - far) / 100000, 0.5 / std::sqrt(density), 0.01);
}

TEST(CellList, IsNotSlowedDownByPointsAtOnePlace) {
    const std::vector<Vec2> points(100000, Vec2{3, 3});
    const CellList cells(points, square_box(10, Boundary::walls));
    NeighbourList found;
    for (int i = 0; i < 100000; ++i) EXPECT_EQ(cells.near(i, 4, 1.2, found).count, 0);
}

}  // namespace
}  // namespace grainfield::analysis
