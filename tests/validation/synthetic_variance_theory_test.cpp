// Number variance from S(k) against closed forms and against the table of the number variance of
// S = min(1, S0 + (ka)^1.12) in square windows (n = 1/a²), which was worked out independently.

#include <array>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "analysis/density/number_variance.h"
#include "analysis/density/synthetic_result.h"
#include "analysis/density/synthetic_variance.h"
#include "analysis/spectra/structure_factor.h"
#include "tests/analysis/synthetic_patterns.h"

namespace grainfield::analysis {
namespace {

using namespace synthetic;

SpectrumModel critical_model(double s0) {
    return SpectrumModel::of_fit({.s0 = s0, .s1 = 1, .alpha = 1.12, .k_end = 0.2});
}

TEST(SyntheticVarianceTheory, AgreesWithTheTableOfInfiniteBoxes) {
    struct Row {
        double window;
        std::array<double, 4> relative;  // for S0 = 0, 0.001, 0.01, 0.1
    };
    const std::vector<Row> table{
        {1, {.9721, .9722, .9729, .9791}},      {3, {.7936, .7941, .7985, .8404}},
        {10, {.3667, .3676, .3755, .4530}},     {20, {.2155, .2165, .2249, .3089}},
        {50, {.1020, .1030, .1118, .1994}},     {80, {.0684, .0694, .0782, .1667}},
        {200, {.0307, .0317, .0406, .1300}},    {1000, {.00715, .00815, .0171, .1070}},
        {10000, {.00083, .00183, .0108, .1008}}};
    const std::array<double, 4> s0{0, 0.001, 0.01, 0.1};
    for (std::size_t column = 0; column < s0.size(); ++column) {
        std::vector<double> windows;
        for (const Row& row : table) windows.push_back(row.window);
        const auto values = synthetic_variance(critical_model(s0[column]), 1, windows);
        for (std::size_t i = 0; i < table.size(); ++i) {
            const double relative = values[i].variance / (windows[i] * windows[i]);
            EXPECT_NEAR(relative, table[i].relative[column], 0.01 * table[i].relative[column])
                << "S0 = " << s0[column] << ", l = " << windows[i];
        }
    }
}

TEST(SyntheticVarianceTheory, AgreesWithTheTableOfABoxOf100Diameters) {
    const std::vector<double> windows{1, 3, 10, 20, 50, 80};
    const std::array<std::array<double, 6>, 2> table{
        {{.9721, .7935, .3667, .2152, .0996, .0600}, {.9791, .8403, .4520, .3045, .1720, .0944}}};
    for (std::size_t column = 0; column < 2; ++column) {
        const auto values =
            synthetic_variance(critical_model(column == 0 ? 0 : 0.1), 1, 100, windows);
        for (std::size_t i = 0; i < windows.size(); ++i) {
            EXPECT_NEAR(values[i].variance / (windows[i] * windows[i]), table[column][i],
                        0.01 * table[column][i])
                << windows[i];
        }
    }
}

TEST(SyntheticVarianceTheory, AtTheCriticalPointHasTheKnownSlope) {
    const auto values = synthetic_variance(critical_model(0), 1, {99, 101});
    const double slope = std::log(values[1].variance / values[0].variance) / std::log(101.0 / 99);
    EXPECT_NEAR(slope - 2, -0.874, 0.01);
}

TEST(SyntheticVarianceTheory, OfUncorrelatedPointsIsTheirNumberAndBinomialInAFiniteBox) {
    // One shell with S = 1, half way to the beyond, where S = 1 too.
    const SpectrumModel poisson =
        SpectrumModel::of_measured({{1.0, 2.0}, {1, 1}, {100, 100}, {0, 0}}, std::nullopt);
    const double n = 1.17;
    const std::vector<double> windows{0.5, 1, 7.3, 20, 39.99, 40};
    const auto infinite = synthetic_variance(poisson, n, windows);
    const auto finite = synthetic_variance(poisson, n, 40, windows);
    for (std::size_t i = 0; i < windows.size(); ++i) {
        const double mean = n * windows[i] * windows[i];
        EXPECT_NEAR(infinite[i].variance, mean, 1e-6 * mean) << windows[i];
        const double share = windows[i] * windows[i] / 1600;
        EXPECT_NEAR(finite[i].variance, mean * (1 - share), 1e-10 * mean) << windows[i];
    }
    EXPECT_NEAR(finite.back().variance, 0, 1e-9);
}

TEST(SyntheticVarianceTheory, OfGinibrePointsIsTheClosedForm) {
    // S = 1 − exp(−k²/4πρ); σ² = ρℓ²(1 − ρ I²), I = erf(√c ℓ)/√ρ − (1 − exp(−cℓ²))/(cℓ), c = πρ.
    const double rho = 0.8;
    Spectrum spectrum;
    for (double k = 0.004; k < 16; k += 0.004) {
        spectrum.k.push_back(k);
        spectrum.s.push_back(1 - std::exp(-k * k / (4 * std::numbers::pi * rho)));
        spectrum.dof.push_back(1e6);
        spectrum.error.push_back(0);
    }
    const SpectrumModel model = SpectrumModel::of_measured(spectrum, std::nullopt);
    const std::vector<double> windows{0.3, 1, 3, 10, 30, 100};
    const auto values = synthetic_variance(model, rho, windows);
    const double c = std::numbers::pi * rho;
    for (std::size_t i = 0; i < windows.size(); ++i) {
        const double l = windows[i];
        const double inside =
            std::erf(std::sqrt(c) * l) / std::sqrt(rho) - (1 - std::exp(-c * l * l)) / (c * l);
        const double wanted = rho * l * l * (1 - rho * inside * inside);
        EXPECT_NEAR(values[i].variance, wanted, 2e-4 * wanted) << l;
    }
}

// The measured variance of a periodic box is the sum over its own modes, mode by mode, so that both
// agree far within their statistical errors; what differs is the averaging over shells and S = 1
// beyond k_max.
TEST(SyntheticVarianceTheory, OfAClusterProcessIsTheVarianceThatIsCounted) {
    const double length = 30;
    const int frames = 60;
    const Box box = square_box(length);
    StructureFactor sk({.k_max = 12}, box, frames);
    NumberVariance counted({.step = 0.5}, box, frames);
    for (int f = 0; f < frames; ++f) {
        RandomStream random(31, "clusters", static_cast<std::uint64_t>(f));
        std::vector<Vec2> points;
        for (int parent = 0; parent < 200; ++parent) {
            const Vec2 at{length * random.uniform(), length * random.uniform()};
            for (int child = 0; child < 5; ++child) {
                points.push_back(at + 0.4 * Vec2{random.normal(), random.normal()});
            }
        }
        const Pattern p = pattern(std::move(points), box, f);
        sk.add(sk.measure(p));
        counted.add(counted.measure(p));
    }
    ObservableResult none;
    none.reason = "not fitted";
    const ObservableResult r =
        synthetic_result(synthetic_input(sk, none), {.sides = std::vector{30.0}});
    ASSERT_EQ(r.curves.size(), 1U);
    const Curve& from_sk = r.curves.front();
    const ObservableResult v = counted.result();
    const auto& l = v.find_curve("variance_pooled")->find("l")->values;
    const auto& sigma2 = v.find_curve("variance_pooled")->find("variance")->values;
    int compared = 0;
    for (std::size_t i = 0; i < from_sk.columns[0].values.size(); ++i) {
        for (std::size_t j = 0; j < l.size(); ++j) {
            if (std::abs(l[j] - from_sk.columns[0].values[i]) > 1e-9 || l[j] > 29) continue;
            EXPECT_NEAR(from_sk.columns[1].values[i], sigma2[j], 0.01 * sigma2[j]) << l[j];
            ++compared;
        }
    }
    EXPECT_GE(compared, 2);  // 1 and 10
    EXPECT_NEAR(from_sk.columns[1].values.back(), 0, 1e-6);
}

// What docs/analysis/density.md says of measurements that end at k = 2/a.
TEST(SyntheticVarianceTheory, SaysWhatShareOfTheVarianceLiesBeyondTheLargestWavevector) {
    const SpectrumModel flat =
        SpectrumModel::of_measured({{1.0, 2.0}, {1, 1}, {100, 100}, {0, 0}}, std::nullopt);
    const auto values = synthetic_variance(flat, 1, {1, 10});
    // Independently: ∫ q A dq/2π by Simpson's rule over k < 2/a.
    const auto below = [](double end) {
        const int n = 4000;
        double sum = 0;
        for (int i = 0; i <= n; ++i) {
            const double q = end * i / n;
            sum += (i == 0 || i == n ? 1 : i % 2 == 1 ? 4 : 2) * q * window_power(q);
        }
        return sum * end / n / 3 / (2 * std::numbers::pi);
    };
    EXPECT_NEAR(values[0].beyond, 1 - below(2), 1e-6);
    EXPECT_NEAR(values[1].beyond / 100, 1 - below(20), 1e-6);
    EXPECT_NEAR(values[0].beyond, 0.730, 0.0005);
    EXPECT_NEAR(values[1].beyond / 100, 0.066, 0.0005);
}

TEST(SyntheticVarianceTheory, OfAnyWindowTendsToItsPowerAtLargeK) {
    // q³ A(q) averaged over a period is 8 where the far form takes over.
    double sum = 0;
    const int n = 64;
    for (int i = 0; i < n; ++i) {
        const double q = 200 + 2 * std::numbers::pi * i / n;
        sum += q * q * q * window_power(q) / n;
    }
    EXPECT_NEAR(sum, 8, 0.004);
    EXPECT_NEAR(window_power(0), 1, 1e-14);
    // Second moment of |w|² over directions: A = 1 − q²/12 + …
    EXPECT_NEAR(window_power(1e-3), 1 - 1e-6 / 12, 1e-12);
}

}  // namespace
}  // namespace grainfield::analysis
