#include "tracking/link/assignment.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::tracking {
namespace {

using Pairs = std::vector<AssignmentPair>;

/// Tries every choice.
double least_cost(std::uint32_t row, std::uint32_t rows, const Pairs& pairs,
                  const std::vector<double>& leave, std::set<std::uint32_t>& taken) {
    if (row == rows) return 0;
    double best = leave[row] + least_cost(row + 1, rows, pairs, leave, taken);
    for (const AssignmentPair& p : pairs) {
        if (p.row != row || taken.contains(p.column)) continue;
        taken.insert(p.column);
        best = std::min(best, p.cost + least_cost(row + 1, rows, pairs, leave, taken));
        taken.erase(p.column);
    }
    return best;
}

/// The cost of a solution; fails if it uses a pair that does not exist or a column twice.
double cost_of(const std::vector<std::int32_t>& column, const Pairs& pairs,
               const std::vector<double>& leave) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, double> cost;
    for (const AssignmentPair& p : pairs) cost[{p.row, p.column}] = p.cost;
    std::set<std::int32_t> used;
    double sum = 0;
    for (std::uint32_t r = 0; r < column.size(); ++r) {
        if (column[r] < 0) {
            sum += leave[r];
            continue;
        }
        EXPECT_TRUE(used.insert(column[r]).second);
        const auto at = cost.find({r, static_cast<std::uint32_t>(column[r])});
        EXPECT_NE(at, cost.end());
        if (at != cost.end()) sum += at->second;
    }
    return sum;
}

/// Linear programming duality: feasible prices of the same sum prove the optimum.
void expect_optimal_by_prices(const AssignmentSolver& solver, double cost, const Pairs& pairs,
                              const std::vector<double>& leave, double tolerance) {
    const auto& u = solver.row_price();
    const auto& v = solver.column_price();
    for (const AssignmentPair& p : pairs) {
        EXPECT_LE(u[p.row] + v[p.column], p.cost + tolerance);
    }
    double sum = 0;
    for (std::size_t r = 0; r < u.size(); ++r) {
        EXPECT_LE(u[r], leave[r] + tolerance);
        sum += u[r];
    }
    for (const double price : v) {
        EXPECT_LE(price, tolerance);
        sum += price;
    }
    EXPECT_NEAR(sum, cost, tolerance * static_cast<double>(1 + u.size()));
}

Pairs random_pairs(std::uint32_t rows, std::uint32_t columns, double share, RandomStream& random,
                   bool whole_numbers) {
    Pairs pairs;
    for (std::uint32_t r = 0; r < rows; ++r) {
        for (std::uint32_t c = 0; c < columns; ++c) {
            if (random.uniform() >= share) continue;
            const double cost = random.uniform(-2, 10);
            pairs.push_back({r, c, whole_numbers ? std::floor(cost) : cost});
        }
    }
    return pairs;
}

TEST(Assignment, IsTheBestOfAllChoices) {
    RandomStream random(1, "assignments");
    AssignmentSolver solver;
    for (int trial = 0; trial < 3000; ++trial) {
        const auto rows = static_cast<std::uint32_t>(random.below(7));
        const auto columns = static_cast<std::uint32_t>(random.below(7));
        // Whole numbers make ties.
        const Pairs pairs =
            random_pairs(rows, columns, random.uniform(0.1, 1), random, trial % 2 == 0);
        std::vector<double> leave(rows);
        for (double& l : leave) l = trial % 3 == 0 ? 6 : random.uniform(0, 12);
        std::set<std::uint32_t> taken;
        const auto column = solver.solve(rows, columns, pairs, leave);
        const double cost = cost_of(column, pairs, leave);
        ASSERT_NEAR(cost, least_cost(0, rows, pairs, leave, taken), 1e-12) << trial;
        expect_optimal_by_prices(solver, cost, pairs, leave, 1e-12);
    }
}

TEST(Assignment, PricesProveTheOptimumOfLargeProblems) {
    RandomStream random(2, "assignments");
    AssignmentSolver solver;
    for (const std::uint32_t n : {60U, 300U, 800U}) {
        const Pairs pairs = random_pairs(n, n - 10, 20.0 / n, random, false);
        const std::vector<double> leave(n, 10.0);
        const auto column = solver.solve(n, n - 10, pairs, leave);
        expect_optimal_by_prices(solver, cost_of(column, pairs, leave), pairs, leave, 1e-9);
    }
}

TEST(Assignment, AChainOfExchangesIsFound) {
    // Every row's cheapest column is taken by the row before; only the last column is free.
    constexpr std::uint32_t kRows = 1000;
    Pairs pairs;
    for (std::uint32_t r = 0; r < kRows; ++r) {
        if (r == 0) {
            pairs.push_back({0, 0, 0.0});
            pairs.push_back({0, 1, 1.0});
        } else {
            pairs.push_back({r, r - 1, 0.0});
            pairs.push_back({r, r, 0.5});
            pairs.push_back({r, r + 1, 2.0});
        }
    }
    AssignmentSolver solver;
    const std::vector<double> leave(kRows, 100.0);
    const auto column = solver.solve(kRows, kRows + 1, pairs, leave);
    expect_optimal_by_prices(solver, cost_of(column, pairs, leave), pairs, leave, 1e-9);
}

TEST(Assignment, APairAsDearAsLeavingIsTakenAndADearerOneIsNot) {
    AssignmentSolver solver;
    EXPECT_EQ(solver.solve(1, 1, Pairs{{0, 0, 4.0}}, std::vector<double>{4.0})[0], 0);
    EXPECT_EQ(solver.solve(1, 1, Pairs{{0, 0, 4.1}}, std::vector<double>{4.0})[0], -1);
}

TEST(Assignment, NoRowsNoColumnsAndNoPairsAreHarmless) {
    AssignmentSolver solver;
    EXPECT_TRUE(solver.solve(0, 5, {}, {}).empty());
    EXPECT_EQ(solver.solve(2, 0, {}, std::vector<double>{1, 1}),
              (std::vector<std::int32_t>{-1, -1}));
}

}  // namespace
}  // namespace grainfield::tracking
