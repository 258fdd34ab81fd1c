#include "analysis/statistics/critical.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

std::vector<CriticalPoint> line_points(double slope, double critical, double error,
                                       RandomStream* random) {
    std::vector<CriticalPoint> points;
    for (int i = 1; i <= 8; ++i) {
        const double x = critical + 0.3 * i;
        const double e = error * (1 + 0.2 * i);
        points.push_back(
            {x, slope * (x - critical) + (random != nullptr ? e * random->normal() : 0), e});
    }
    return points;
}

TEST(Critical, OfExactPointsIsWhereTheLineReachesZero) {
    const auto points = line_points(0.7, 5.2, 0.01, nullptr);
    const CriticalFit fit = fit_critical(points, CriticalLine::free);
    EXPECT_EQ(fit.reason, "");
    EXPECT_NEAR(*fit.critical, 5.2, 1e-12);
    EXPECT_NEAR(fit.slope, 0.7, 1e-12);
    EXPECT_NEAR(fit.chi2, 0, 1e-20);
    EXPECT_LT(fit.interval->low, 5.2);
    EXPECT_GT(fit.interval->high, 5.2);
    const auto through = line_points(0.7, 0, 0.01, nullptr);
    const CriticalFit zero = fit_critical(through, CriticalLine::through_zero);
    EXPECT_NEAR(zero.slope, 0.7, 1e-12);
    EXPECT_FALSE(zero.critical.has_value());
    EXPECT_NE(zero.reason, "");
}

// 2000 trials: 68.3 % inside, binomial standard deviation 1.04 %; five of them.
TEST(Critical, HasAnIntervalThatHoldsTheTruthInTwoThirdsOfTheTrials) {
    int inside = 0;
    double chi2 = 0;
    for (std::uint64_t trial = 0; trial < 2000; ++trial) {
        RandomStream random(61, "critical", trial);
        const auto points = line_points(0.7, 5.2, 0.05, &random);
        const CriticalFit fit = fit_critical(points, CriticalLine::free);
        ASSERT_TRUE(fit.interval.has_value());
        inside += fit.interval->low < 5.2 && 5.2 < fit.interval->high;
        chi2 += fit.chi2 / 2000;
    }
    EXPECT_NEAR(inside / 2000.0, 0.6827, 0.052);
    EXPECT_NEAR(chi2, 6, 5 * std::sqrt(12.0 / 2000));
}

TEST(Critical, GivesReasonsInPlaceOfNumbers) {
    const auto points = line_points(0.7, 5.2, 0.01, nullptr);
    EXPECT_EQ(fit_critical(points, CriticalLine::power).points, 0);
    EXPECT_NE(fit_critical(points, CriticalLine::power).reason, "");
    EXPECT_NE(fit_critical({}, CriticalLine::free).reason, "");
    const std::vector<CriticalPoint> same{{1, 0.1, 0.1}, {1, 0.2, 0.1}, {1, 0.3, 0.1}};
    EXPECT_NE(fit_critical(same, CriticalLine::free).reason, "");
    const std::vector<CriticalPoint> no_error{{1, 0.1, 0}, {2, 0.2, 0.1}, {3, 0.3, 0.1}};
    EXPECT_NE(fit_critical(no_error, CriticalLine::free).reason, "");
    const std::vector<CriticalPoint> flat{{1, 0.1, 0.1}, {2, 0.1, 0.1}, {3, 0.1001, 0.1}};
    const CriticalFit fit = fit_critical(flat, CriticalLine::free);
    EXPECT_FALSE(fit.interval.has_value());
    EXPECT_NE(fit.reason.find("the same at all values"), std::string::npos);
    // The slope is 0.05 ± 0.0707: 2.83 times too uncertain.
    const std::vector<CriticalPoint> weak{{1, 0.1, 0.1}, {2, 0.15, 0.1}, {3, 0.2, 0.1}};
    EXPECT_NE(fit_critical(weak, CriticalLine::free)
                  .reason.find("runs 8 times as long, or 2.8 times the range"),
              std::string::npos);
}

}  // namespace
}  // namespace grainfield::analysis
