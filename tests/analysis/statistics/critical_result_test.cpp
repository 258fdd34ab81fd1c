#include "analysis/statistics/critical_result.h"

#include <cmath>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace grainfield::analysis {
namespace {

const Measurement& measured(const ObservableResult& result, const char* name) {
    const Measurement* m = result.find_measurement(name);
    if (m == nullptr) throw std::runtime_error(name);
    return *m;
}

TEST(CriticalResult, ValueOutsideTheRunsSaysSo) {
    std::vector<CriticalPoint> outside;
    for (int i = 1; i <= 8; ++i) outside.push_back({5.2 + 0.3 * i, 0.21 * i, 0.01});
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

TEST(CriticalResult, PowersHaveTheirOwnNumbersAndCurve) {
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

TEST(CriticalResult, GivesReasonsInPlaceOfNumbers) {
    const std::vector<CriticalPoint> flat{{1, 0.1, 0.1}, {2, 0.1, 0.1}, {3, 0.1001, 0.1}};
    for (const Measurement& m :
         critical_result(flat, CriticalLine::free, "nu", std::nullopt).measurements) {
        if (!m.value || !m.error) {
            EXPECT_NE(m.reason, "") << m.name;
        }
    }
}

}  // namespace
}  // namespace grainfield::analysis
