#include "analysis/bond_order.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

constexpr NeighbourRule all_rules[] = {NeighbourRule::near_four, NeighbourRule::near_delaunay,
                                       NeighbourRule::four_nearest, NeighbourRule::delaunay,
                                       NeighbourRule::fixed_cutoff};

// A patch of a triangular lattice, periodic: rows of `m`, spacing 1.
Pattern hexagonal(int m) {
    const double height = std::sqrt(3.0) / 2;
    std::vector<Vec2> points;
    for (int iy = 0; iy < m; ++iy) {
        for (int ix = 0; ix < m; ++ix) points.push_back({ix + 0.5 * (iy % 2), iy * height});
    }
    const double side = m;
    return pattern(points,
                   Box{{0, 0}, {side, side * height}, {Boundary::periodic, Boundary::periodic}, 0});
}

TEST(BondOrder, OfASquareLatticeIsOneForEveryRuleButPlainDelaunay) {
    RandomStream random(1, "square");
    const Pattern p = pattern(square_lattice(20, 1, 0, random), square_box(20));
    for (NeighbourRule rule : all_rules) {
        if (rule == NeighbourRule::delaunay) continue;
        const BondOrderField field = bond_order(p, {.rule = rule});
        for (std::size_t i = 0; i < p.size(); ++i) {
            EXPECT_NEAR(std::abs(field.q[i]), 1, 1e-12);
            EXPECT_EQ(field.neighbours[i], 4);
            EXPECT_NEAR(field.mean_four[i], 1, 1e-12);
        }
    }
}

TEST(BondOrder, OfATriangularLatticeIsZeroForFourAndOneForSix) {
    const Pattern p = hexagonal(20);
    const BondOrderField four = bond_order(p, {});
    const BondOrderField six = bond_order(p, {.symmetry = 6});
    const BondOrderField six_delaunay =
        bond_order(p, {.rule = NeighbourRule::near_delaunay, .symmetry = 6});
    for (std::size_t i = 0; i < p.size(); ++i) {
        EXPECT_NEAR(std::abs(four.q[i]), 0, 1e-12);
        EXPECT_NEAR(std::abs(six.q[i]), 1, 1e-12);
        EXPECT_NEAR(std::abs(six_delaunay.q[i]), 1, 1e-12);
    }
}

TEST(BondOrder, IsTheMeanOfUnitPowersComputedByTrigonometry) {
    RandomStream random(2, "trigonometry");
    const Box box = square_box(12);
    const Pattern p = pattern(poisson_points(150, box, random), box);
    for (int k : {1, 2, 3, 4, 5, 6, 8, 12}) {
        const BondOrderField field =
            bond_order(p, {.rule = NeighbourRule::fixed_cutoff, .symmetry = k, .cutoff = 2.5});
        for (std::size_t i = 0; i < p.size(); ++i) {
            std::complex<double> sum;
            double count = 0;
            for (std::size_t j = 0; j < p.size(); ++j) {
                const Vec2 d = box.minimum_image(p.position[j] - p.position[i]);
                if (i == j || squared_norm(d) >= 6.25) continue;
                sum += std::polar(1.0, k * std::atan2(d.y, d.x));
                count += 1;
            }
            EXPECT_LT(std::abs(field.q[i] - sum / count), 1e-12);
        }
    }
}

TEST(BondOrder, KeepsItsModulusUnderTranslationQuarterTurnAndReordering) {
    RandomStream random(3, "symmetry");
    const Box box = square_box(20);
    const std::vector<Vec2> points = square_lattice(20, 1, 0.1, random);
    for (NeighbourRule rule : all_rules) {
        const BondOrderField before = bond_order(pattern(points, box), {.rule = rule});
        std::vector<Vec2> moved, turned, reversed(points.rbegin(), points.rend());
        for (Vec2 p : points) {
            moved.push_back(p + Vec2{3.3, -7.1});
            turned.push_back({-p.y, p.x});
        }
        const BondOrderField a = bond_order(pattern(moved, box), {.rule = rule});
        const BondOrderField b = bond_order(pattern(turned, box), {.rule = rule});
        const BondOrderField c = bond_order(pattern(reversed, box), {.rule = rule});
        for (std::size_t i = 0; i < points.size(); ++i) {
            EXPECT_LT(std::abs(a.q[i] - before.q[i]), 1e-11);
            EXPECT_LT(std::abs(b.q[i] - before.q[i]), 1e-11);
            EXPECT_LT(std::abs(c.q[points.size() - 1 - i] - before.q[i]), 1e-11);
        }
    }
}

TEST(BondOrder, IsUndefinedWithoutNeighbours) {
    const Box box = square_box(10, Boundary::walls);
    for (NeighbourRule rule : all_rules) {
        const BondOrderField one = bond_order(pattern({{1, 1}}, box), {.rule = rule});
        EXPECT_TRUE(std::isnan(one.q[0].real()));
        EXPECT_EQ(one.neighbours[0], 0);
        EXPECT_TRUE(std::isnan(one.nearest[0]));
        EXPECT_TRUE(bond_order(pattern({}, box), {.rule = rule}).q.empty());
        const BondOrderField same =
            bond_order(pattern(std::vector<Vec2>(30, Vec2{4, 4}), box), {.rule = rule});
        EXPECT_TRUE(std::isnan(same.q[7].real()));
        const BondOrderField two = bond_order(pattern({{1, 1}, {2, 1}}, box), {.rule = rule});
        EXPECT_NEAR(std::abs(two.q[0]), 1, 1e-12);
        EXPECT_TRUE(std::isnan(two.mean_four[0]));
    }
}

TEST(BondOrder, IsAsPreciseFarFromTheOriginAsTheCoordinatesAllow) {
    RandomStream random(4, "far");
    std::vector<Vec2> points = square_lattice(20, 1, 0.05, random);
    const BondOrderField near = bond_order(pattern(points, square_box(20)), {});
    for (Vec2& p : points) p += Vec2{1e6, 1e6};
    const BondOrderField far =
        bond_order(pattern(points, square_box(20, Boundary::periodic, {1e6, 1e6})), {});
    // Coordinates near 1e6 are rounded to 1.2e-10.
    for (std::size_t i = 0; i < points.size(); ++i) {
        EXPECT_LT(std::abs(far.q[i] - near.q[i]), 1e-8);
    }
}

}  // namespace
}  // namespace grainfield::analysis
