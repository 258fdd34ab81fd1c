#include "analysis/order/histogram_modes.h"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "core/support/random.h"

namespace grainfield::analysis {
namespace {

std::vector<double> mixture(double low_share, std::size_t n, std::uint64_t seed) {
    RandomStream random(seed, "mixture");
    std::vector<double> counts(50, 0.0);
    for (std::size_t i = 0; i < n; ++i) {
        const bool low = random.uniform() < low_share;
        const double x =
            std::abs(low ? 0.33 + 0.13 * random.normal() : 0.95 + 0.03 * random.normal());
        if (x < 1) counts[static_cast<std::size_t>(x * 50)] += 1;
    }
    return counts;
}

struct Features {
    double low, minimum, high;
};

// The extrema of the smoothed expectation of the counts.
Features truth() {
    const auto below = [](double x, double mean, double width) {
        return 0.5 * std::erfc((mean - x) / (width * std::sqrt(2.0)));
    };
    const auto inside = [&](double low, double high, double mean, double width) {  // of |x|
        return below(high, mean, width) - below(low, mean, width) + below(-low, mean, width) -
               below(-high, mean, width);
    };
    std::vector<double> counts;
    for (int b = 0; b < 50; ++b) {
        const double low = b / 50.0;
        const double high = (b + 1) / 50.0;
        counts.push_back(
            1e9 * (0.7 * inside(low, high, 0.33, 0.13) + 0.3 * inside(low, high, 0.95, 0.03)));
    }
    const HistogramModes modes = find_modes(counts);
    return {*modes.low_mode, *modes.minimum, *modes.high_mode};
}

TEST(HistogramModes, OfAMixtureAreFoundWithTheMinimumBetween) {
    const HistogramModes modes = find_modes(mixture(0.7, 10000, 1));
    ASSERT_TRUE(modes.minimum.has_value()) << modes.reason;
    // Where the smoothed mixture itself has its peaks and its minimum (see `truth`).
    const Features wanted = truth();
    EXPECT_NEAR(*modes.low_mode, wanted.low, 6 * *modes.low_mode_error);
    EXPECT_NEAR(*modes.high_mode, wanted.high, 6 * *modes.high_mode_error);
    EXPECT_NEAR(*modes.minimum, wanted.minimum, 6 * *modes.minimum_error);
    EXPECT_LT(*modes.low_mode_error, 0.01);
    EXPECT_LT(*modes.high_mode_error, 0.002);
    EXPECT_LT(*modes.minimum_error, 0.02);
}

TEST(HistogramModes, OfOnePeakHaveNoMinimumButAReason) {
    const HistogramModes modes = find_modes(mixture(1, 10000, 2));
    EXPECT_FALSE(modes.minimum.has_value());
    EXPECT_FALSE(modes.reason.empty());
    // |x| of a normal with 2.5 standard deviations below: folding shifts the peak by less than
    // 1e-3.
    EXPECT_NEAR(*modes.low_mode, 0.33, 6 * *modes.low_mode_error + 1e-3);
}

// The pull of 400 trials: its mean has a standard error of 0.05 and its width of 0.035; ±0.25 and
// ±0.21 are more than five of them (p < 1e-6).
TEST(HistogramModes, HaveErrorsThatCoverTheTruth) {
    const Features wanted = truth();
    const int trials = 400;
    std::array<double, 3> sum{}, squares{};
    for (int trial = 0; trial < trials; ++trial) {
        // Each particle counted four times: a quarter of the counts is independent.
        std::vector<double> counts = mixture(0.7, 10000, 1000 + static_cast<std::uint64_t>(trial));
        for (double& c : counts) c *= 4;
        const HistogramModes m = find_modes(counts, 0.25);
        ASSERT_TRUE(m.minimum_error && m.low_mode_error && m.high_mode_error);
        const std::array<double, 3> pull{(*m.low_mode - wanted.low) / *m.low_mode_error,
                                         (*m.minimum - wanted.minimum) / *m.minimum_error,
                                         (*m.high_mode - wanted.high) / *m.high_mode_error};
        for (std::size_t i = 0; i < 3; ++i) {
            sum[i] += pull[i];
            squares[i] += pull[i] * pull[i];
        }
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const double mean = sum[i] / trials;
        EXPECT_NEAR(mean, 0, 0.25) << i;
        EXPECT_NEAR(std::sqrt(squares[i] / trials - mean * mean), 1, 0.21) << i;
    }
}

TEST(HistogramModes, AreNotInventedFromCountingNoise) {
    // Some 45 pairs of independent smoothed bins and 6 standard errors: 45 · 2e-9 = 9e-8 a trial,
    // below 1e-6 for ten of them.
    int found = 0;
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
        RandomStream random(seed, "flat");
        std::vector<double> counts(50);
        for (double& c : counts) c = static_cast<double>(random.poisson(200));
        found += find_modes(counts).minimum.has_value();
    }
    EXPECT_EQ(found, 0);
}

TEST(HistogramModes, OfAnEmptyHistogramGiveAReason) {
    EXPECT_FALSE(find_modes(std::vector<double>(50, 0.0)).reason.empty());
    EXPECT_FALSE(find_modes(std::vector<double>(3, 1.0)).reason.empty());
}

}  // namespace
}  // namespace grainfield::analysis
