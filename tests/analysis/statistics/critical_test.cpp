#include "analysis/statistics/critical.h"

#include <cmath>
#include <stdexcept>
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
    for (const Measurement& m :
         critical_result(flat, CriticalLine::free, "nu", std::nullopt).measurements) {
        if (!m.value || !m.error) {
            EXPECT_NE(m.reason, "") << m.name;
        }
    }
}

const Measurement& measured(const ObservableResult& result, const char* name) {
    const Measurement* m = result.find_measurement(name);
    if (m == nullptr) throw std::runtime_error(name);
    return *m;
}

TEST(Critical, ValueOutsideTheRunsSaysSo) {
    const auto outside = line_points(0.7, 5.2, 0.01, nullptr);  // runs from 5.5 on
    const ObservableResult result = critical_result(outside, CriticalLine::free, "Γ", std::nullopt);
    EXPECT_EQ(measured(result, "critical_value").reason,
              "outside the runs, which are from 5.5 to 7.6");
    std::vector<CriticalPoint> around = outside;
    around.push_back({4.9, -0.21, 0.01});
    EXPECT_EQ(
        measured(critical_result(around, CriticalLine::free, "Γ", std::nullopt), "critical_value")
            .reason,
        "");
}

TEST(Critical, PowersHaveTheirOwnNumbersAndCurve) {
    std::vector<CriticalPoint> points;
    for (const double x : {1e-4, 2e-4, 5e-4, 1e-3, 2e-3}) {
        const double ratio = 3 * std::pow(x, 0.7);
        points.push_back({x, ratio, 0.01 * ratio});
    }
    const ObservableResult power = critical_result(points, CriticalLine::power, "ν",
                                                   Measurement{"alpha", "-", 1.4, 0.1, 5, ""});
    EXPECT_NEAR(*measured(power, "power").value, 0.7, 1e-6);
    EXPECT_EQ(measured(power, "chi2_per_dof").samples, 3);
    EXPECT_EQ(measured(power, "critical_value").reason, "a power vanishes at zero");
    EXPECT_EQ(*measured(power, "alpha").value, 1.4);
    EXPECT_EQ(power.find_measurement("slope"), nullptr);
    const Curve* curve = power.find_curve("critical_line");
    ASSERT_NE(curve, nullptr);
    EXPECT_EQ(curve->find("x")->values.front(), 0);
    EXPECT_EQ(curve->find("x")->values.back(), 2e-3);
    EXPECT_NEAR(curve->find("s0_over_s1")->values.back(), points.back().ratio, 1e-6);
    for (CriticalPoint& p : points) p.ratio += 0.1;
    const ObservableResult both =
        critical_result(points, CriticalLine::power_and_constant, "ν", std::nullopt);
    EXPECT_NEAR(*measured(both, "constant").value, 0.1, 1e-6);
    EXPECT_EQ(measured(both, "chi2_per_dof").samples, 2);
    // What cannot be fitted keeps the points, and a reason.
    points.front().x = -1;
    const ObservableResult refused =
        critical_result(points, CriticalLine::power, "ν", std::nullopt);
    EXPECT_NE(refused.reason, "");
    EXPECT_EQ(refused.curves.size(), 1U);
    for (const ObservableResult* result : {&power, &both}) {
        for (const Measurement& m : result->measurements) {
            if (!m.value || !m.error) {
                EXPECT_NE(m.reason, "") << m.name;
            }
        }
    }
}

}  // namespace
}  // namespace grainfield::analysis
