#include "simulate/md/engine/ledger.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::simulate {

// Sizes from 1e-18 to 1e14 within one sum.
TEST(ExactSum, DoesNotDependOnTheOrderOfItsTerms) {
    RandomStream random(1, "ledger");
    std::vector<double> terms(2000);
    for (double& t : terms) t = random.normal() * std::pow(10, random.uniform(-18, 14));
    ExactSum forward;
    ExactSum parts[2];
    for (const double t : terms) forward.add(t);
    for (std::size_t i = terms.size(); i-- > 0;) parts[i % 3 == 0].add(terms[i]);
    parts[0].add(parts[1]);
    EXPECT_EQ(forward.value(), parts[0].value());
}

// A window of the elastic gas at N = 340,736 and T = 4 adds 3.4e7, at T = 1e9 and N = 1e8 3e18.
TEST(ExactSum, HoldsTheHottestRuns) {
    ExactSum sum;
    for (int i = 0; i < 10000; ++i) sum.add(3e14);
    EXPECT_EQ(sum.value(), 3e18);
    for (int i = 0; i < 10000; ++i) sum.add(-4e15);
    EXPECT_EQ(sum.value(), -3.7e19);
}

TEST(ExactSum, KeepsTheSmallestLossesOfTheColdestRuns) {
    ExactSum sum;
    for (int i = 0; i < 1000; ++i) sum.add(1e-14 / 3);
    EXPECT_NEAR(sum.value() / (1e-11 / 3), 1, 1e-7);
    sum.add(1e9);
    sum.add(-1e9);
    EXPECT_NEAR(sum.value() / (1e-11 / 3), 1, 1e-7) << "large terms must not hide small ones";
}

TEST(ExactSum, SaysThatItIsLostInsteadOfWrappingAround) {
    for (const double term : {1e16, -1e300, std::numeric_limits<double>::infinity(),
                              std::numeric_limits<double>::quiet_NaN()}) {
        ExactSum sum;
        sum.add(1);
        sum.add(term);
        EXPECT_TRUE(std::isnan(sum.value())) << term;
    }
}

}  // namespace grainfield::simulate
