#include "analysis/motion/pair_sums.h"

#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

TEST(PairSums, EqualTheNaiveSumForAnyRangeAndLag) {
    RandomStream random(1, "pairs");
    std::vector<double> x(60), y(60), w(60), zero_x, zero_y;
    for (std::size_t i = 0; i < 60; ++i) {
        x[i] = random.normal();
        y[i] = random.normal();
        w[i] = random.uniform() < 0.7 ? 1 : 0;
    }
    for (std::size_t lag : {1U, 2U, 7U, 31U, 59U}) {
        for (std::size_t first = 0; first + lag < 60; ++first) {
            for (std::size_t last = first; last + lag <= 60; ++last) {
                long double plain = 0, masked = 0;
                double pairs = 0;
                for (std::size_t i = first; i < last; ++i) {
                    const long double dx = x[i + lag] - x[i];
                    const long double dy = y[i + lag] - y[i];
                    plain += dx * dx + dy * dy;
                    if (w[i] * w[i + lag] > 0) {
                        masked += dx * dx + dy * dy;
                        pairs += 1;
                    }
                }
                double count = 0;
                EXPECT_NEAR(sum_squared_steps(x.data(), y.data(), first, last, lag),
                            static_cast<double>(plain), 1e-12);
                EXPECT_NEAR(
                    sum_squared_steps_masked(x.data(), y.data(), w.data(), first, last, lag, count),
                    static_cast<double>(masked), 1e-12);
                EXPECT_EQ(count, pairs);
            }
        }
    }
}

}  // namespace
}  // namespace grainfield::analysis
