#include "analysis/statistics/critical_power.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

struct Law {
    double constant = 0;
    double factor = 1;
    double power = 1;
    double at(double x) const { return constant + factor * std::pow(x, power); }
};

// At eight ν as those of the field model, with errors of a share of the ratio.
std::vector<CriticalPoint> points_of(const Law& law, double share, RandomStream* random) {
    std::vector<CriticalPoint> points;
    double x = 1e-4;
    for (int i = 0; i < 8; ++i, x *= 2) {
        const double error = share * law.at(x);
        points.push_back(
            {x, law.at(x) + (random != nullptr ? error * random->normal() : 0), error});
    }
    return points;
}

TEST(CriticalPower, OfExactPointsIsTheirLaw) {
    for (const double power : {0.2, 0.732, 1.0, 2.5}) {
        const Law law{0, 13, power};
        const CriticalPower fit =
            fit_critical_power(points_of(law, 0.01, nullptr), PowerConstant::none);
        ASSERT_EQ(fit.reason, "");
        EXPECT_NEAR(fit.power, power, 1e-7 * power);
        EXPECT_NEAR(fit.factor / law.factor, 1, 1e-6);
        EXPECT_EQ(fit.constant, 0);
        EXPECT_EQ(fit.constant_error, 0);
        EXPECT_NEAR(fit.chi2, 0, 1e-9);
        EXPECT_NEAR(fit.value(0.003), law.at(0.003), 1e-6 * law.at(0.003));
        EXPECT_EQ(fit.value(0), 0);
    }
    const Law with{0.085, 2, 0.5};
    const CriticalPower fit =
        fit_critical_power(points_of(with, 0.01, nullptr), PowerConstant::free);
    ASSERT_EQ(fit.reason, "");
    EXPECT_NEAR(fit.constant, with.constant, 1e-6);
    EXPECT_NEAR(fit.power, with.power, 1e-6);
    EXPECT_NEAR(fit.value(0), with.constant, 1e-6);
    EXPECT_EQ(fit.value_error(0), fit.constant_error);
}

// In double logarithmic axes a power is a line, whose slope has the error 1/√Σ w (u − ū)².
TEST(CriticalPower, HasTheErrorOfTheSlopeInDoubleLogarithmicAxes) {
    const double share = 0.02;
    const auto points = points_of({0, 13, 0.7}, share, nullptr);
    double mean = 0;
    for (const CriticalPoint& p : points) mean += std::log(p.x) / 8;
    double sum = 0;
    for (const CriticalPoint& p : points) {
        sum += (std::log(p.x) - mean) * (std::log(p.x) - mean) / (share * share);
    }
    const CriticalPower fit = fit_critical_power(points, PowerConstant::none);
    EXPECT_NEAR(fit.power_error * std::sqrt(sum), 1, 1e-6);
    // At the reference, the mean of ln x, the fit has the error of a mean of eight points.
    EXPECT_NEAR(fit.value_error(fit.reference) / fit.value(fit.reference), share / std::sqrt(8.0),
                1e-6);
}

// 2000 trials: 68.3 % inside, binomial standard deviation 1.04 %; five of them.
TEST(CriticalPower, HoldsTheTruthWithinItsErrorsInTwoThirdsOfTheTrials) {
    const Law law{0.05, 3, 0.7};
    int power = 0, constant = 0, factor = 0, value = 0;
    double chi2 = 0;
    for (std::uint64_t trial = 0; trial < 2000; ++trial) {
        RandomStream random(67, "critical-power", trial);
        const CriticalPower fit =
            fit_critical_power(points_of(law, 0.005, &random), PowerConstant::free);
        ASSERT_EQ(fit.reason, "");
        power += std::abs(fit.power - law.power) < fit.power_error;
        constant += std::abs(fit.constant - law.constant) < fit.constant_error;
        factor += std::abs(fit.factor - law.factor) < fit.factor_error;
        value += std::abs(fit.value(0.002) - law.at(0.002)) < fit.value_error(0.002);
        chi2 += fit.chi2 / 2000;
    }
    for (const int inside : {power, constant, factor, value}) {
        EXPECT_NEAR(inside / 2000.0, 0.6827, 0.052);
    }
    EXPECT_NEAR(chi2, 5, 5 * std::sqrt(10.0 / 2000));
}

TEST(CriticalPower, GivesReasonsInPlaceOfNumbers) {
    const auto reason = [](std::vector<CriticalPoint> points, PowerConstant constant) {
        return fit_critical_power(points, constant).reason;
    };
    EXPECT_NE(reason({}, PowerConstant::none).find("2 are needed"), std::string::npos);
    EXPECT_NE(reason({{1, 0.1, 0.1}, {2, 0.2, 0.1}}, PowerConstant::free).find("3 are needed"),
              std::string::npos);
    EXPECT_NE(reason({{0, 0.1, 0.1}, {2, 0.2, 0.1}}, PowerConstant::none).find("above 0"),
              std::string::npos);
    EXPECT_NE(reason({{1, 0.1, 0}, {2, 0.2, 0.1}}, PowerConstant::none).find("no error"),
              std::string::npos);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(reason({{1, nan, 0.1}, {2, 0.2, 0.1}}, PowerConstant::none).find("no value"),
              std::string::npos);
    EXPECT_NE(reason({{1, 0.1, 0.1}, {1, 0.2, 0.1}}, PowerConstant::none).find("same value"),
              std::string::npos);
    // S0/S1 that falls as the parameter grows has no power that vanishes at zero.
    EXPECT_NE(reason({{1, 0.3, 0.01}, {2, 0.2, 0.01}, {4, 0.1, 0.01}}, PowerConstant::none)
                  .find("end of its range"),
              std::string::npos);
}

}  // namespace
}  // namespace grainfield::analysis
