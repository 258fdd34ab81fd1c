#include "analysis/order/bond_order.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

constexpr NeighbourRule all_rules[] = {NeighbourRule::near_four,    NeighbourRule::near_delaunay,
                                       NeighbourRule::four_nearest, NeighbourRule::delaunay,
                                       NeighbourRule::fixed_cutoff, NeighbourRule::voronoi_edge,
                                       NeighbourRule::edge_weighted};

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
        // The diagonals of squares have edges as long as the coordinates are rounded.
        const bool is_weighted = rule == NeighbourRule::edge_weighted;
        for (std::size_t i = 0; i < p.size(); ++i) {
            EXPECT_NEAR(std::abs(field.q[i]), 1, is_weighted ? 1e-6 : 1e-12);
            EXPECT_GE(field.neighbours[i], 4);
            EXPECT_LE(field.neighbours[i], is_weighted ? 8 : 4);
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

// Voronoi cells by cutting a square with the bisector of every other point: the edge to each.
std::vector<double> edges_by_clipping(const std::vector<Vec2>& points, const Box& box,
                                      std::size_t i) {
    struct Corner {
        Vec2 at;
        int beyond;  // the point across the edge that begins here; −1: a wall, or far away
    };
    const bool walls = box.boundary[0] == Boundary::walls;
    const Vec2 p = points[i];
    const Vec2 low = walls ? box.origin - p : -0.5 * box.length;
    const Vec2 high = low + box.length;
    std::vector<Corner> cell{{low, -1}, {{high.x, low.y}, -1}, {high, -1}, {{low.x, high.y}, -1}};
    for (std::size_t j = 0; j < points.size(); ++j) {
        if (j == i) continue;
        const Vec2 d = box.minimum_image(points[j] - p);
        const auto beyond = [&](Vec2 at) { return dot(at - 0.5 * d, d); };
        std::vector<Corner> left;
        for (std::size_t c = 0; c < cell.size(); ++c) {
            const Corner& from = cell[c];
            const Corner& to = cell[(c + 1) % cell.size()];
            const double a = beyond(from.at);
            const double b = beyond(to.at);
            const Vec2 cut = from.at + a / (a - b) * (to.at - from.at);
            if (a <= 0) left.push_back(from);
            if (a <= 0 && b > 0) left.push_back({cut, static_cast<int>(j)});
            if (a > 0 && b <= 0) left.push_back({cut, from.beyond});
        }
        cell = left;
    }
    std::vector<double> edges(points.size(), 0.0);
    for (std::size_t c = 0; c < cell.size(); ++c) {
        if (cell[c].beyond < 0) continue;
        edges[static_cast<std::size_t>(cell[c].beyond)] +=
            norm(cell[(c + 1) % cell.size()].at - cell[c].at);
    }
    return edges;
}

// Whether a particle is a neighbour, and how much it weighs, as each rule says it, from all
// distances and the edges of clipped Voronoi cells.
std::vector<double> weights_by_rule(const std::vector<double>& r, const std::vector<double>& edges,
                                    const BondOrderOptions& options) {
    std::vector<double> all, touching;
    double perimeter = 0;
    for (std::size_t j = 0; j < r.size(); ++j) {
        if (r[j] > 0) all.push_back(r[j]);
        if (edges[j] > 0) touching.push_back(r[j]);
        perimeter += edges[j];
    }
    std::sort(all.begin(), all.end());
    std::sort(touching.begin(), touching.end());
    const auto mean_four = [](const std::vector<double>& s) {
        return (s[0] + s[1] + s[2] + s[3]) / 4;
    };
    std::vector<double> weights;
    for (std::size_t j = 0; j < r.size(); ++j) {
        double w = 0;
        if (r[j] > 0) {
            switch (options.rule) {
                case NeighbourRule::near_four:
                    w = r[j] < options.factor * mean_four(all);
                    break;
                case NeighbourRule::near_delaunay:
                    w = edges[j] > 0 && r[j] < options.factor * mean_four(touching);
                    break;
                case NeighbourRule::four_nearest:
                    w = r[j] <= all[3];
                    break;
                case NeighbourRule::delaunay:
                    w = edges[j] > 0;
                    break;
                case NeighbourRule::fixed_cutoff:
                    w = r[j] < options.cutoff;
                    break;
                case NeighbourRule::voronoi_edge:
                    w = edges[j] > options.edge * perimeter / 4;
                    break;
                case NeighbourRule::edge_weighted:
                    w = edges[j];
                    break;
            }
        }
        weights.push_back(w);
    }
    return weights;
}

TEST(BondOrder, IsForEveryRuleAndSymmetryThatOfAllDistancesAndClippedCells) {
    RandomStream random(9, "oracle");
    for (const Boundary boundary : {Boundary::periodic, Boundary::walls}) {
        const Box box{{-3, 5}, {14, 11}, {boundary, boundary}, 0};
        const std::vector<Vec2> points = poisson_points(160, box, random);
        const Pattern p = pattern(points, box);
        for (const NeighbourRule rule : all_rules) {
            // Between walls a pair of the hull may share an edge outside the box only.
            if (boundary == Boundary::walls &&
                (rule == NeighbourRule::delaunay || rule == NeighbourRule::near_delaunay)) {
                continue;
            }
            for (const int k : {1, 2, 3, 4, 5, 6, 7, 12, 24}) {
                const BondOrderOptions options{.rule = rule, .symmetry = k, .cutoff = 1.9};
                const BondOrderField field = bond_order(p, options);
                for (std::size_t i = 0; i < points.size(); ++i) {
                    std::vector<double> r, angle;
                    for (const Vec2& q : points) {
                        const Vec2 d = box.minimum_image(q - points[i]);
                        r.push_back(norm(d));
                        angle.push_back(std::atan2(d.y, d.x));
                    }
                    const std::vector<double> weights =
                        weights_by_rule(r, edges_by_clipping(points, box, i), options);
                    std::complex<double> sum;
                    double total = 0;
                    int count = 0;
                    for (std::size_t j = 0; j < r.size(); ++j) {
                        sum += weights[j] * std::polar(1.0, k * angle[j]);
                        total += weights[j];
                        count += weights[j] > 0;
                    }
                    ASSERT_EQ(field.neighbours[i], count) << static_cast<int>(rule);
                    if (count == 0) continue;
                    ASSERT_LT(std::abs(field.q[i] - sum / total), 1e-7)
                        << static_cast<int>(rule) << ", k " << k;
                }
            }
        }
    }
}

TEST(BondOrder, KeepsItsModulusUnderTranslationQuarterTurnAndReordering) {
    RandomStream random(3, "symmetry");
    const Box box = square_box(20);
    const std::vector<Vec2> points = square_lattice(20, 1, 0.1, random);
    for (NeighbourRule rule : all_rules) {
        // Which points of a near square touch is decided on a grid of 2^-30 of the box.
        const double tolerance = rule == NeighbourRule::edge_weighted ? 1e-7 : 1e-11;
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
            EXPECT_LT(std::abs(a.q[i] - before.q[i]), tolerance);
            EXPECT_LT(std::abs(b.q[i] - before.q[i]), tolerance);
            EXPECT_LT(std::abs(c.q[points.size() - 1 - i] - before.q[i]), tolerance);
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
